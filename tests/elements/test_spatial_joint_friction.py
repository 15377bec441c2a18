"""Friction in joints in space: each kind against the braking that its load and its radius give."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, spatial
from stiffmbs.compile.state import State
from stiffmbs.spatial import AppliedForce, AppliedTorque, Body, JointFriction, Marker, Model

from ..random_parts import add_joints, three_bodies_in_space
from .test_element_derivatives import assert_close, derivative, term

INERTIA = (0.04, 0.05, 0.06)
Z = np.array([1, 2, 2]) / 3
X = np.array([2, 1, -2]) / 3
Y = np.cross(Z, X)


def held(joint, speed=0.0, spin=(0, 0, 0), force=(0, 0, 0), torque=(0, 0, 0), **friction):
    """A body on a joint to ground along an axis askew, let go with a speed along it and a spin, under a load at its centre."""
    model = Model()
    axes = {"z": tuple(Z), "x": tuple(X)}
    velocity = tuple(speed * Z)
    model.add("body", Body(mass=2, inertia=INERTIA, orientation=axes, velocity=velocity, omega=spin))
    model.add("joint", joint(i="body", j=Marker(body="ground", orientation=axes)))
    model.add("load", AppliedForce(i="body", force=tuple(force[0] * X + force[1] * Y + force[2] * Z)))
    model.add("twist", AppliedTorque(i="body", torque=tuple(torque[0] * X + torque[1] * Y + torque[2] * Z)))
    model.add("rubbing", JointFriction(joint="joint", friction=0.1, **friction))
    return model


def run(model, duration=0.2):
    return stiffmbs.run(model, duration=duration, rtol=1e-9, points=5)


def along_axis(solution, letter="v"):
    return np.array([solution[f"body.{letter}{axis}"] for axis in "xyz"]).T @ Z


def test_a_pin_is_braked_by_the_force_across_it():
    solution = run(held(spatial.Revolute, spin=(0, 0, 10), force=(30, 40, 1000), radius=0.02))
    np.testing.assert_allclose(solution["body.wz"], 10 - 0.1 * 50 * 0.02 / 0.06 * solution.time, atol=1e-7)
    braking = np.array([solution[f"rubbing.t{axis}"] for axis in "xyz"]).T
    np.testing.assert_allclose(braking, np.tile(-0.1 * 50 * 0.02 * Z, (5, 1)), atol=1e-9)


@pytest.mark.long
def test_a_bearing_is_pressed_by_its_moment_and_a_collar_by_the_thrust():
    fields = {"radius": 0.02, "length": 0.2, "thrust_radius": 0.05}
    solution = run(held(spatial.Revolute, spin=(0, 0, -10), force=(0, 50, -70), torque=(3, 4, 0), **fields))
    torque = 0.1 * ((50 + 5 / 0.1) * 0.02 + 70 * 0.05)
    np.testing.assert_allclose(solution["body.wz"], -10 + torque / 0.06 * solution.time, atol=1e-7)


@pytest.mark.long
def test_a_guide_is_pressed_by_force_moment_and_torsion():
    fields = {"torsion_radius": 0.05, "length": 0.2}
    solution = run(held(spatial.Prismatic, speed=3, force=(30, 40, 0), torque=(3, 4, 2), **fields))
    pressure = 50 + 5 / 0.1 + 2 / 0.05
    np.testing.assert_allclose(along_axis(solution), 3 - 0.1 * pressure / 2 * solution.time, atol=1e-7)


@pytest.mark.long
def test_a_sleeve_rubs_against_the_velocity_of_its_surface():
    """The direction of sliding (v, R w) stays where mass and I/R^2 are as large as each other; the friction is mu N."""
    R = np.sqrt(0.06 / 2)
    solution = run(held(spatial.Cylindrical, speed=3, spin=(0, 0, -4 / R), force=(30, 40, 0), radius=R))
    slowing = 0.1 * 50 / 2 * solution.time
    np.testing.assert_allclose(along_axis(solution), 3 - 3 / 5 * slowing, atol=1e-7)
    np.testing.assert_allclose(R * solution["body.wz"], -4 + 4 / 5 * slowing, atol=1e-7)


@pytest.mark.long
def test_a_ball_is_braked_against_its_angular_velocity():
    model = held(spatial.Spherical, spin=(0, 6, 0), force=(0, 30, 40), radius=0.02)
    solution = run(model)
    np.testing.assert_allclose(solution["body.wy"], 6 - 0.1 * 50 * 0.02 / 0.05 * solution.time, atol=1e-7)


@pytest.mark.long
def test_a_body_stays_where_friction_holds_it():
    """It creeps as the smoothing says: tanh(v/v_smooth) = load/(mu N)."""
    model = held(spatial.Prismatic, force=(30, 40, 3), stiction_velocity=1e-3)
    assert along_axis(run(model, 0.5))[-1] == pytest.approx(1e-3 * np.arctanh(3 / 5), rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    "joint",
    ["revolute", *(pytest.param(each, marks=pytest.mark.long) for each in ("cylindrical", "prismatic")), "spherical"],
)
def test_derivatives_by_position_velocity_and_reaction(joint):
    rng = np.random.default_rng(5)
    model = three_bodies_in_space(rng)
    add_joints(model)
    like = model.joints["slider" if joint == "prismatic" else "pin"]
    kind = {"revolute": spatial.Revolute, "cylindrical": spatial.Cylindrical, "prismatic": spatial.Prismatic}
    own = {} if joint in ("cylindrical", "spherical") else {"length": 0.3}
    own |= {"length": 0.3, "thrust_radius": 0.4} if joint == "revolute" else {}
    model.add("held", kind.get(joint, spatial.Spherical)(i=like.i, j=like.j))
    smooth = {"stiction_velocity": 0.8, "static_friction": 0.5, "friction_velocity": 0.7}
    model.add("rubbing", JointFriction(joint="held", friction=0.3, radius=0.2, **smooth, **own))
    state = State(stiffmbs.compile_model(model.data()))
    state.lam[:] = rng.uniform(0.5, 1.5, len(state.lam))
    for name, vector in (("f_q", state.q), ("f_u", state.u), ("f_lam", state.lam)):
        assert_close(term(state, "tangent", name), derivative(lambda: term(state, "motion", "f"), vector))


@pytest.mark.parametrize(
    ("joint", "fields", "message"),
    [
        (spatial.Revolute, {}, "radius: found none for the revolute joint 'joint', expected the radius of its pin"),
        (spatial.Fixed, {"radius": 1}, "which is of type fixed, expected a cylindrical, prismatic, revolute or spherical joint"),
        (spatial.Prismatic, {"thrust_radius": 1}, "thrust_radius: found one for the prismatic joint 'joint', expected"),
        (spatial.Spherical, {"radius": 1, "length": 1}, "length: found one for the spherical joint 'joint', expected none"),
    ],
)  # fmt: skip
def test_what_does_not_fit_the_joint_is_said(joint, fields, message):
    with pytest.raises(InputError, match=message):
        held(joint, **fields).data()
