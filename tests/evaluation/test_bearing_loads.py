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
