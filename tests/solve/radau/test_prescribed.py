"""Prescribed motions: the error of a step's end is zero, whatever the length of the step."""

import numpy as np
import pytest

import stiffmbs

CRANK = """
bodies: {crank: {mass: 1, inertia: 0.1}, rod: {mass: 1, inertia: 0.1, position: [0.35, 0]}, slider: {mass: 1, inertia: 1, position: [0.6, 0]}}
joints:
  pin: {type: revolute, i: crank, j: ground}
  big: {type: revolute, i: {body: crank, point: [0.1, 0]}, j: {body: rod, point: [-0.25, 0]}}
  small: {type: revolute, i: {body: rod, point: [0.25, 0]}, j: slider}
  guide: {type: prismatic, i: slider, j: ground}
  motor: {type: drive, joint: pin, position: 20*t}
run: {duration: 20, points: 2001, solver: radau}
"""


@pytest.mark.parametrize("rtol", [0.1, 1e-2, 1e-3, 1e-4])
def test_states_within_long_steps_stay_on_the_branch_of_the_joints(rtol):
    """Stages of steps of a whole turn had converged to the slider on the other side of the crank, an error of 1 m."""
    found = stiffmbs.run(stiffmbs.read_scene(CRANK), rtol=rtol)
    turn = 20 * found.time
    np.testing.assert_allclose(
        found["slider.x"], 0.1 * np.cos(turn) + np.sqrt(0.25 - 0.01 * np.sin(turn) ** 2), atol=1e-9
    )
    assert not any("energy balance" in note for note in found.notes)


@pytest.mark.parametrize(
    ("radius", "position", "rtol"), [(0.1, "1000*t", 1e-6), (0.2, "1000*t", 0.1), (0.24, "20*sin(10*t)", 0.1)]
)
def test_angles_keep_their_turns_in_long_steps(radius, position, rtol):
    """Newton's iteration had turned the rod by 2 to 16 revolutions in steps of half a turn of the crank, without an error."""
    scene = CRANK.replace("20*t", f'"{position}"').replace("point: [0.1, 0]", f"point: [{radius}, 0]")
    scene = scene.replace("[0.35, 0]", f"[{radius + 0.25}, 0]").replace("[0.6, 0]", f"[{radius + 0.5}, 0]")
    found = stiffmbs.run(stiffmbs.read_scene(scene), rtol=rtol, duration=1.0)
    np.testing.assert_allclose(found["rod.angle"], -np.arcsin(radius / 0.5 * np.sin(found["crank.angle"])), atol=1e-6)
