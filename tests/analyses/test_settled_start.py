"""Runs that start in the pose of the equilibrium with the described velocities."""

import numpy as np
import pytest

import stiffmbs

SCENE = """
gravity: [0, -10]
bodies: {load: {mass: 2, inertia: 1, velocity: [0, 0.3]}}
joints: {rail: {type: prismatic, i: load, j: {body: ground, angle: 90 deg}}}
forces: {spring: {type: spring_damper, i: load, j: {body: ground, point: [0, 1]}, stiffness: 200, free_length: 1}}
start: settled
run: {duration: 1 s, points: 101, rtol: 1e-9}
"""


def test_a_load_swings_about_where_it_would_hang():
    found = stiffmbs.run(stiffmbs.read_scene(SCENE))
    assert found["load.y"] == pytest.approx(-0.1 + 0.03 * np.sin(10 * found.time), abs=1e-7)
    assert any("at the start was not checked" in note for note in found.notes)


def test_an_equilibrium_far_from_the_described_pose_is_told():
    near, far = (stiffmbs.run(stiffmbs.read_scene(SCENE.replace("-10", weight))) for weight in ("-10", "-40"))
    assert not any("away from the described pose" in note for note in near.notes)
    assert any("is 0.4 m away from the described pose (load)" in note for note in far.notes)


def test_a_steady_motion_far_from_the_described_pose_is_told():
    text = """
bodies: {sledge: {mass: 1, inertia: 1, velocity: [2, 0]}, load: {mass: 2, inertia: 1, velocity: [2, 0]}}
joints:
  rail: {type: prismatic, i: sledge, j: ground}
  guide: {type: prismatic, i: load, j: {body: sledge, angle: 90 deg}}
forces: {spring: {type: spring_damper, i: load, j: {body: sledge, point: [0, 1]}, stiffness: 200, free_length: 1}}
start: {velocity: [2, 0]}
run: {duration: 1 s}
"""
    near, far = (stiffmbs.run(stiffmbs.read_scene(f"gravity: [0, {weight}]{text}")) for weight in (-10, -40))
    assert not any("away from the described pose" in note for note in near.notes)
    assert any("is 0.4 m away from the described pose (load)" in note for note in far.notes)


@pytest.mark.parametrize(("travel", "noted"), [(1.5, False), (2.5, True)])
@pytest.mark.parametrize("motion", ["", "start: {velocity: [2, 0]}"])
def test_an_equilibrium_farther_away_than_the_model_is_large_is_noted(travel, noted, motion):
    """The model has a size of 1 m, and the load sags by m g/k."""
    scene = SCENE.replace("start: settled", motion).replace("stiffness: 200", f"stiffness: {20 / travel}")
    if motion:
        scene = scene.replace("i: load, j: {body: ground,", "i: load, j: {body: sledge,").replace(
            "{load:", "{sledge: {mass: 1, inertia: 1}, load:"
        )
        scene = scene.replace("joints: {", "joints: {road: {type: prismatic, i: sledge, j: ground}, ")
    found = stiffmbs.equilibrium(stiffmbs.read_scene(scene))
    assert found.moved["load"][0] == pytest.approx(travel, rel=1e-6)
    note = f"load is {travel:g} m away from the described pose, more than 2 times the size of the model of 1 m: check the stiffnesses"
    assert any(note in each for each in found.notes) == noted


@pytest.mark.parametrize("law", ["position: 0.3*t", "velocity: 0.3 m/s"])
def test_drives_move_from_an_equilibrium_at_once(law):
    """A load hangs at rest on a hook that begins to rise with 0.3 m/s."""
    upwards = "orientation: {z: [0, 1, 0]}"
    text = f"""
dimensions: 3
gravity: [0, -10, 0]
bodies:
  load: {{mass: 2, inertia: [1, 1, 1], position: [0, -1, 0]}}
  hook: {{mass: 1, inertia: [1, 1, 1]}}
joints:
  rail: {{type: prismatic, i: {{body: load, {upwards}}}, j: {{body: hook, {upwards}}}}}
  guide: {{type: prismatic, i: {{body: hook, {upwards}}}, j: {{body: ground, {upwards}}}}}
  lift: {{type: drive, joint: guide, {law}}}
forces: {{spring: {{type: spring_damper, i: load, j: hook, stiffness: 200, free_length: 1}}}}
start: equilibrium
run: {{duration: 1 s, points: 101, rtol: 1e-9}}
"""
    found = stiffmbs.run(stiffmbs.read_scene(text))
    assert found.message == "completed"
    assert found["load.y"] == pytest.approx(-1.1 + 0.3 * found.time - 0.03 * np.sin(10 * found.time), abs=1e-7)
    assert found["hook.vy"] == pytest.approx(0.3, abs=1e-9)
