"""Joints in space: the freedoms that each leaves, and its equations along the motions that it allows."""

import numpy as np
import pytest

from stiffmbs import InputError, compile_model, spatial
from stiffmbs.compile.reactions import reactions
from stiffmbs.compile.state import State
from stiffmbs.elements.spatial.orientation import about, matrix, product

from ..spatial_pairs import two_bodies

LENGTH = 0.8
NOWHERE = (0.0, 0.0, 0.0)


def turned(sequence, *angles):
    """The quaternion of turns about an axis after the other, as it has been turned so far."""
    p = (1.0, 0.0, 0.0, 0.0)
    for axis, angle in zip(sequence, angles, strict=True):
        p = product(p, about("xyz".index(axis), angle))
    return p


def any_turn(rng):
    return turned("zxz", *rng.uniform(-np.pi, np.pi, 3))


def about_z(rng):
    return turned("z", rng.uniform(-np.pi, np.pi))


def opposite(rng):
    return turned("zx", rng.uniform(-np.pi, np.pi), np.pi)


def on_z(rng):
    return (0.0, 0.0, rng.uniform(-1, 1))


def on_plane(rng):
    return (*rng.uniform(-1, 1, 2), 0.0)


def anywhere(rng):
    return tuple(rng.uniform(-1, 1, 3))


def at_right_angles(rng):
    a, b = rng.uniform(-np.pi, np.pi, 2)
    return turned("zxz", a, np.pi / 2, b)


def bent(rng):
    """A bend about an axis in the bisecting plane, without twist."""
    a, bend = rng.uniform(-np.pi, np.pi), rng.uniform(-1.2, 1.2)
    return turned("zxz", a, bend, -a)


def at_length(rng):
    d = rng.normal(size=3)
    return tuple(LENGTH * d / np.linalg.norm(d))


def on_circle(rng):
    a = rng.uniform(-np.pi, np.pi)
    return (LENGTH * np.cos(a), LENGTH * np.sin(a), 0.0)


def unmoved(rng):
    return NOWHERE


def unturned(rng):
    return (1.0, 0.0, 0.0, 0.0)


ROD = {"length": LENGTH}
SCREW = {"pitch": 0.3, "offset": 0.0}
JOINTS = {
    "revolute": (spatial.Revolute, {}, 1, unmoved, about_z),
    "revolute with opposite axes": (spatial.Revolute, {}, 1, unmoved, opposite),
    "prismatic": (spatial.Prismatic, {}, 1, on_z, unturned),
    "prismatic with opposite axes": (spatial.Prismatic, {}, 1, on_z, lambda rng: turned("x", np.pi)),
    "cylindrical": (spatial.Cylindrical, {}, 2, on_z, about_z),
    "cylindrical with opposite axes": (spatial.Cylindrical, {}, 2, on_z, opposite),
    "spherical": (spatial.Spherical, {}, 3, unmoved, any_turn),
    "universal": (spatial.Universal, {}, 2, unmoved, at_right_angles),
    "constant_velocity": (spatial.ConstantVelocity, {}, 2, unmoved, bent),
    "constant_velocity with opposite axes": (
        spatial.ConstantVelocity, {}, 2, unmoved, lambda rng: product(bent(rng), turned("x", np.pi)),
    ),
    "screw": (spatial.Screw, SCREW, 1, unmoved, unturned),
    "thread": (spatial.Thread, SCREW, 5, unmoved, unturned),
    "planar": (spatial.Planar, {}, 3, on_plane, about_z),
    "planar with opposite axes": (spatial.Planar, {}, 3, on_plane, opposite),
    "fixed": (spatial.Fixed, {}, 0, unmoved, unturned),
    "distance": (spatial.Distance, ROD, 5, at_length, any_turn),
    "revolute_spherical": (spatial.RevoluteSpherical, ROD, 4, on_circle, any_turn),
    "point_on_line": (spatial.PointOnLine, {}, 4, on_z, any_turn),
    "point_on_plane": (spatial.PointOnPlane, {}, 5, on_plane, any_turn),
    "orientation": (spatial.Orientation, {}, 3, anywhere, unturned),
    "parallel": (spatial.Parallel, {}, 4, anywhere, about_z),
    "parallel with opposite axes": (spatial.Parallel, {}, 4, anywhere, opposite),
    "perpendicular": (spatial.Perpendicular, {}, 5, anywhere, at_right_angles),
}  # fmt: skip
"""By name: class, fields, freedoms between two bodies, and places and turns of marker i in marker j that it allows."""


def equations(element, fields, seed, apart, p):
    """C and J of a joint between two bodies with marker i at a place and of an orientation p in marker j."""
    axis, angle = np.array(p[1:]), 2 * np.arctan2(np.linalg.norm(p[1:]), p[0])
    turn = (axis if np.any(axis) else (0, 0, 1), angle)
    state = State(compile_model(two_bodies(element, seed, apart=apart, turn=turn, **fields).data()))
    state.evaluate("motion", 0.37)
    return state.vector("motion", "C"), state.matrix("motion", "J")


@pytest.mark.parametrize("name", JOINTS)
def test_equations_hold_wherever_the_joint_allows_and_leave_its_freedoms(name):
    element, fields, freedoms, place, turn = JOINTS[name]
    rng = np.random.default_rng(11)
    for seed in range(5):
        C, J = equations(element, fields, seed, place(rng), turn(rng))
        assert np.max(np.abs(C)) < 1e-14
        assert np.linalg.matrix_rank(J, tol=1e-9) == len(C) == 6 - freedoms == len(element.equations)


@pytest.mark.parametrize("name", JOINTS)
def test_every_equation_is_broken_by_other_motions(name):
    element, fields, _, place, turn = JOINTS[name]
    rng = np.random.default_rng(12)
    other = product(turn(rng), turned("xyz", 0.2, -0.3, 0.25))
    C, _ = equations(element, fields, 3, tuple(np.add(place(rng), (0.3, -0.2, 0.4))), other)
    assert np.min(np.abs(C)) > 1e-2


@pytest.mark.parametrize(
    ("element", "turn", "words"),
    [
        (spatial.Revolute, ("x", 1.2), "drawn 68.75 degrees apart, expected less than 60 or more than 120"),
        (spatial.Planar, ("x", 1.2), "drawn 68.75 degrees apart"),
        (spatial.Universal, ("x", 0.3), "drawn 17.19 degrees apart, expected between 30 and 150"),
        (spatial.Perpendicular, ("x", 3.0), "drawn 171.9 degrees apart"),
        (spatial.Prismatic, ("z", 1.4), "drawn 80.21 degrees apart, expected less than 60, from no turn or from half"),
        (spatial.Orientation, ("z", np.pi), "drawn 180 degrees apart, expected less than 60"),
        (spatial.Fixed, ("x", np.pi), "drawn 180 degrees apart"),
    ],
)
def test_axes_drawn_on_a_wrong_branch_are_refused(element, turn, words):
    axis, angle = turn
    with pytest.raises(InputError, match=f"element: found the (z )?axes of its markers {words}"):
        two_bodies(element, 1, apart=NOWHERE, turn=(np.eye(3)["xyz".index(axis)], angle)).data()


@pytest.mark.parametrize("element", [spatial.Screw, spatial.Thread])
def test_a_turn_carries_a_screw_on_by_its_pitch(element):
    for angle in (-2.9, 0.4, 1.0, 3.0):
        place = (0.0, 0.0, SCREW["pitch"] * angle / (2 * np.pi))
        C, J = equations(element, SCREW, 5, place, turned("z", angle))
        assert np.max(np.abs(C)) < 1e-14
        assert np.linalg.matrix_rank(J, tol=1e-9) == len(element.equations)
        C, _ = equations(element, SCREW, 5, place, turned("z", angle + 0.1))
        assert C[-1] == pytest.approx(-SCREW["pitch"] * 0.1 / (2 * np.pi), abs=1e-14)


@pytest.mark.parametrize("name", JOINTS)
def test_what_a_joint_does_to_one_body_it_undoes_on_the_other(name):
    """-J^T lam makes opposite forces and torques about the origin, and the reaction is that on the first body."""
    element, fields, _, place, turn = JOINTS[name]
    rng = np.random.default_rng(13)
    p = turn(rng)
    axis, angle = np.array(p[1:]), 2 * np.arctan2(np.linalg.norm(p[1:]), p[0])
    model = two_bodies(element, 4, apart=place(rng), turn=(axis if np.any(axis) else (0, 0, 1), angle), **fields)
    system = compile_model(model.data())
    state = State(system)
    state.lam[:] = rng.uniform(-1, 1, system.n_c)
    state.evaluate("motion", 0.0)
    state.evaluate("output", 0.0)
    effort = -(state.matrix("motion", "J").T @ state.lam).reshape(2, 6)
    q = state.q[:14].reshape(2, 7)
    torques = [matrix(own[3:]) @ f[3:] + np.cross(own[:3], f[:3]) for own, f in zip(q, effort, strict=True)]
    np.testing.assert_allclose(effort[0, :3], -effort[1, :3], atol=1e-14)
    np.testing.assert_allclose(torques[0], -torques[1], atol=1e-14)
    found = reactions(system, state.values["output"][None])
    force, torque = (np.array([found[f"element.{part}{axis}"][0] for axis in "xyz"]) for part in "ft")
    point = model.data().initial_marker(model.joints["element"].i).point
    np.testing.assert_allclose(force, effort[0, :3], atol=1e-14)
    np.testing.assert_allclose(torque + np.cross(point, force), torques[0], atol=1e-14)
