"""Loads in the axes of bodies, in space and in the plane."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import stiffmbs

from ..conftest import EXAMPLES


def test_loads_in_space_are_turned_into_the_axes_of_their_bodies():
    scene = EXAMPLES / "spatial_slider_crank.yaml"
    solution = stiffmbs.run(scene, duration=0.5)
    found = next(load for load in stiffmbs.loads(solution) if load.unit == "N")
    data = stiffmbs.load_scene(scene)
    ends = [getattr({**data.joints, **data.forces}[found.element], end).body for end in "ij"]
    in_axes = stiffmbs.in_body_axes(scene, solution, found)
    assert list(in_axes) == ends
    for sign, (body, vectors) in zip((1.0, -1.0), in_axes.items(), strict=True):
        expected = sign * found.components
        if body != "ground":
            q = np.column_stack([solution[f"{body}.q{k}"] for k in (1, 2, 3, 0)])
            expected = Rotation.from_quat(q).inv().apply(expected)
        assert vectors == pytest.approx(expected, abs=1e-9 * found.peak)


def test_the_weight_of_a_spinning_disc_goes_around_its_hub_and_rests_on_the_ground():
    text = """
gravity: [0, -9.81]
bodies: {disc: {mass: 2, inertia: 1, omega: 3}}
joints: {hub: {type: revolute, i: disc, j: ground}}
run: {duration: 4 s}
"""
    scene = stiffmbs.read_scene(text)
    solution = stiffmbs.run(scene, rtol=1e-9)
    (load,) = stiffmbs.loads(solution)
    in_axes = stiffmbs.in_body_axes(scene, solution, load)
    angle, weight = 3.0 * solution.time, 2 * 9.81
    assert in_axes["ground"] == pytest.approx(np.column_stack([0 * angle, np.full_like(angle, -weight)]), abs=1e-6)
    turned = weight * np.column_stack([np.sin(angle), np.cos(angle)])
    assert in_axes["disc"] == pytest.approx(turned, abs=1e-5)


def test_a_load_of_another_model_is_refused():
    solution = stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1)
    with pytest.raises(stiffmbs.InputError, match="'hinge'"):
        stiffmbs.in_body_axes(EXAMPLES / "crank_slider.yaml", solution, stiffmbs.loads(solution)[0])


SLIDING_BLOCK = """
gravity: [0, -9.81]
bodies:
  slope: {mass: 1, inertia: 1, angle: 0.4}
  block: {mass: 2, inertia: 1, angle: 0.4}
joints:
  hinge: {type: revolute, i: slope, j: ground}
  rail: {type: prismatic, i: {body: block, angle: 0}, j: {body: slope, angle: 0}}
  tilt: {type: drive, joint: hinge, position: 0.4 + t}
  push: {type: drive, joint: rail, position: 0.1*t}
run: {duration: 1 s, points: 11}
"""


def test_a_drive_loads_the_bodies_of_its_joint():
    scene = stiffmbs.read_scene(SLIDING_BLOCK)
    solution = stiffmbs.run(scene, rtol=1e-9)
    push = next(load for load in stiffmbs.loads(solution) if load.element == "push")
    in_axes = stiffmbs.in_body_axes(scene, solution, push)
    assert list(in_axes) == ["block", "slope"]
    # along the rail: m (s'' - s w^2) = F - m g sin(angle), with s = 0.1 t and w = 1
    t = solution.time
    expected = 2.0 * (-0.1 * t + 9.81 * np.sin(0.4 + t))
    for sign, vectors in zip((1.0, -1.0), in_axes.values(), strict=True):
        assert vectors == pytest.approx(np.column_stack([sign * expected, 0.0 * t]), abs=1e-6)
    torque = next(load for load in stiffmbs.loads(solution) if load.element == "tilt")
    assert list(stiffmbs.in_body_axes(scene, solution, torque)) == ["slope", "ground"]


def test_elements_of_later_stages_are_found():
    text = """
bodies: {a: {mass: 1, inertia: 1, position: [1, 0]}}
joints: {pin: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}}
run: {duration: 1, points: 201}
stages:
  - {}
  - change:
      joints: {motor: {type: drive, joint: pin, velocity: 20}}
      forces: {spring: {type: torsion_spring, i: a, j: ground, stiffness: 3}}
"""
    scene = stiffmbs.read_scene(text)
    solution = stiffmbs.run(scene)
    for load in stiffmbs.loads(solution):
        assert list(stiffmbs.in_body_axes(scene, solution, load)) == ["a", "ground"]
    angle = stiffmbs.driving_angle(scene, solution)
    assert angle.joint == "pin" and solution.time[angle.rows[0]] == pytest.approx(2 - np.pi / 10, abs=0.01)
