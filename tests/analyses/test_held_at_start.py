"""Joints and drives that hold at the start alone."""

import pytest

import stiffmbs

TEXT = """
gravity: [0, -9.81]
bodies:
  bar: {mass: 1.2, inertia: 0.036, position: [0.3, 0]}
  tip: {mass: 1, inertia: 0.1, position: [0.9, 0]}
joints:
  hinge: {type: revolute, i: {body: bar, point: [-0.3, 0]}, j: ground}
  knee: {type: revolute, i: {body: tip, point: [-0.3, 0]}, j: {body: bar, point: [0.3, 0]}}
at_start:
  tilt: {type: drive, joint: hinge, position: 0.4}
  turn: {type: drive, joint: hinge, velocity: 2}
  bend: {type: drive, joint: knee, position: -0.2}
run: {duration: 0.1, points: 2}
"""


def test_a_run_starts_where_they_hold_and_goes_on_without_them():
    found = stiffmbs.run(stiffmbs.read_scene(TEXT), rtol=1e-9)
    assert (found["bar.angle"][0], found["tip.angle"][0]) == pytest.approx((0.4, 0.2), abs=1e-12)
    assert found["bar.omega"][0] == pytest.approx(2, abs=1e-12)
    assert "tilt.torque" not in found.channels and abs(found["bar.omega"][-1] - 2) > 0.1
    assert found["energy.total"][-1] == pytest.approx(found["energy.total"][0], rel=1e-8)
    # nothing holds the knee's velocity: of all velocities with this hinge's, it has the least energy
    held = TEXT.replace("bend:", "swing: {type: drive, joint: knee, velocity: 0}\n  bend:")
    assert found["energy.kinetic"][0] < stiffmbs.run(stiffmbs.read_scene(held))["energy.kinetic"][0]


def test_a_pin_that_holds_at_the_start_holds_velocities_too():
    text = """
bodies:
  crank: {mass: 1, inertia: 0.01, position: [0.1, 0]}
  rod: {mass: 1, inertia: 0.01, position: [0.4, 0]}
joints: {hinge: {type: revolute, i: {body: crank, point: [-0.1, 0]}, j: ground}}
forces: {mount: {type: bushing, i: {body: rod, point: [-0.2, 0]}, j: {body: crank, point: [0.1, 0]}, stiffness: [1e8, 1e8, 0], damping: [2e3, 2e3, 0]}}
at_start:
  pin: {type: revolute, i: {body: rod, point: [-0.2, 0]}, j: {body: crank, point: [0.1, 0]}}
  spin: {type: drive, joint: hinge, velocity: 20}
run: {duration: 1 ms, points: 2}
"""
    found = stiffmbs.run(stiffmbs.read_scene(text))
    end = found["rod.vy"][0] - 0.2 * found["rod.omega"][0]
    assert (found["crank.omega"][0], end) == pytest.approx((20, 4), rel=1e-12)
    assert abs(found["mount.fy"][0]) < 1e-6  # 8 kN if the rod were at rest


def test_a_study_varies_a_scene_with_them():
    found = stiffmbs.sweep(
        stiffmbs.read_scene(TEXT), {"at_start.turn.velocity": [1, 2]}, outputs=["bar.omega", "bar.angle"]
    )
    assert found["bar.omega"].values[:, 0] == pytest.approx([1, 2], abs=1e-12)
    assert found["bar.angle"].values[:, 0] == pytest.approx(0.4, abs=1e-12)
    found = stiffmbs.sweep(stiffmbs.read_scene(TEXT), {"bodies.tip.mass": [1, 2]}, outputs=["bar.omega"])
    assert found["bar.omega"].values[:, 0] == pytest.approx(2, abs=1e-12)


def test_they_can_be_changed_from_outside():
    scene = stiffmbs.read_scene(TEXT, [("at_start.tilt.position", "90 deg")])
    assert stiffmbs.run(scene)["bar.x"][0] == pytest.approx(0, abs=1e-12)
    scene = stiffmbs.read_scene(TEXT, [("at_start", "{upright: {type: drive, joint: hinge, position: 90 deg}}")])
    assert stiffmbs.run(scene)["bar.x"][0] == pytest.approx(0, abs=1e-12)


def test_a_stage_after_the_first_begins_where_the_one_before_it_ends():
    found = stiffmbs.run(stiffmbs.read_scene(TEXT + "stages: [{run: {duration: 0.1}}, {run: {duration: 0.1}}]\n"))
    whole = stiffmbs.run(stiffmbs.read_scene(TEXT), duration=0.2)
    assert (found["bar.angle"][0], found["bar.angle"][-1]) == pytest.approx((0.4, whole["bar.angle"][-1]), rel=1e-5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TEXT.replace("tilt:", "hinge:"), "at_start: found 'hinge', a joint of the scene"),
        (
            TEXT.replace("joint: hinge, position", "joint: hing, position"),
            "at_start, joints.tilt.joint: found the unknown joint 'hing'",
        ),
    ],
)
def test_what_is_wrong_with_them_is_told_when_the_scene_is_read(text, words):
    with pytest.raises(stiffmbs.InputError, match=words):
        stiffmbs.read_scene(text)


def test_drives_that_contradict_each_other_are_told():
    text = TEXT.replace("at_start:", "at_start:\n  other: {type: drive, joint: hinge, position: 0.5}")
    with pytest.raises(stiffmbs.StiffmbsError):
        stiffmbs.run(stiffmbs.read_scene(text))
