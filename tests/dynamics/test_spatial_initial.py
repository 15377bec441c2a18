"""Assembly in space: what it moved is told, by turns in rad, and what cannot be assembled is named."""

import math
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import AssemblyError, InputError
from stiffmbs.compile.bodies import SPACE
from stiffmbs.elements.spatial.orientation import product
from stiffmbs.spatial import Body, Marker, Model, Revolute, Spherical

from ..spatial_loops import door, parallelogram, slider_crank

UPRIGHT = {"z": (0, 0, 1)}


def arm(turn=0.0, offset=0.0, **motion):
    """An arm on an upright hinge, drawn turned about x by so much, and off its place."""
    model = Model()
    orientation = {"x": (1, 0, 0), "y": (0, math.cos(turn), math.sin(turn))}
    body = {"mass": 1, "inertia": (0.04, 0.1, 0.1), "position": (2, offset, 0), "orientation": orientation}
    arm = model.add("arm", Body(**body | motion))
    model.add("hinge", Revolute(i=arm.at(-2, 0, 0, UPRIGHT), j=Marker(body="ground", orientation=UPRIGHT)))
    return model


def note(model):
    return " ".join(stiffmbs.run(model, duration=0.01, points=2).notes)


@pytest.mark.parametrize("turn", [1e-6, 0.01, 0.3, 1.0])
def test_a_turn_is_told_by_its_angle(turn):
    found = re.search(r"assembly changed arm.angle by (\S+) rad", note(arm(turn)))
    assert float(found[1]) == pytest.approx(turn, rel=1e-2)


def test_moves_and_velocities_are_told_apart():
    told = note(arm(offset=0.25, omega=(0.5, 0, 2)))
    assert re.search(
        r"arm by \S+ m, arm\.angle by \S+ rad \(\S+ deg\) and arm's velocity by \S+ m/s, arm\.omega by \S+ rad/s$", told
    )
    assert "nothing" not in told


def test_a_start_that_fits_is_left_alone():
    assert note(arm(omega=(0, 0, 2), velocity=(0, 4, 0))) == ""


def test_a_gap_is_named_with_its_joint():
    """Two arms of 4 m on balls, to a point 9 m away."""
    model = arm()
    rod = model.add("rod", Body(mass=1, inertia=(0.04, 0.1, 0.1), position=(6, 0, 0)))
    model.add("elbow", Spherical(i=rod.at(-2, 0, 0), j=Marker(body="arm", point=(2, 0, 0))))
    model.add("far", Spherical(i=rod.at(2, 0, 0), j=Marker(body="ground", point=(9, 0, 0.5))))
    with pytest.raises(AssemblyError, match=r"cannot be assembled: .*joint '(far|elbow|hinge)'"):
        stiffmbs.run(model, duration=0.1)


def test_moves_between_poses_are_inverse_to_moving():
    rng = np.random.default_rng(3)
    q = rng.normal(size=(5, 7))
    q[:, 3:] /= np.linalg.norm(q[:, 3:], axis=1, keepdims=True)
    step = rng.uniform(-1.5, 1.5, 30)
    there = SPACE.moved(q.ravel(), step)
    np.testing.assert_allclose(SPACE.move(q.ravel(), there), step, atol=1e-13)
    flipped = (there.reshape(5, 7) * [1, 1, 1, -1, -1, -1, -1]).ravel()  # the same orientations
    np.testing.assert_allclose(SPACE.move(q.ravel(), flipped), step, atol=1e-13)
    np.testing.assert_allclose(SPACE.move(there, there), 0.0, atol=1e-15)


@pytest.mark.long
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(seed=st.integers(0, 2**32 - 1))
def test_assembly_finds_the_branch_that_is_drawn(seed):
    """Linkages drawn far from closed: no joint comes out with its axes opposite, where its equations hold too."""
    rng = np.random.default_rng(seed)
    for model in (slider_crank(0.7), parallelogram(1.0), door()):
        for name, body in model.bodies.items():
            axis, half = rng.normal(size=3), rng.uniform(0.1, 0.5)
            turn = (math.cos(half), *(math.sin(half) * axis / np.linalg.norm(axis)))
            place = tuple(np.array(body.position) + rng.uniform(-0.3, 0.3, 3))
            model.bodies[name] = body.model_copy(
                update={"position": place, "orientation": product(body.orientation, turn)}
            )
        try:
            solution = stiffmbs.run(model, duration=1e-6, points=2)
        except InputError as refused:
            assert "degrees apart" in str(refused)
            continue
        bodies = {
            name: body.model_copy(update={
                "position": tuple(float(solution[f"{name}.{c}"][0]) for c in "xyz"),
                "orientation": tuple(float(solution[f"{name}.q{c}"][0]) for c in range(4)),
            })
            for name, body in model.bodies.items()
        }  # fmt: skip
        assembled = model.data().model_copy(update={"bodies": bodies})
        for joint in model.joints.values():
            i, j = assembled.initial_marker(joint.i), assembled.initial_marker(joint.j)
            if joint.kind != "spherical":
                np.testing.assert_allclose(i.z @ j.z, 1.0, atol=1e-9)
            if joint.kind == "prismatic":
                np.testing.assert_allclose(i.x @ j.x, 1.0, atol=1e-9)
