"""Turns of joint angles in space at the start: drives, gears, screws, forces and requests agree on them."""

import numpy as np
import pytest
import yaml

import stiffmbs
from stiffmbs.model.read_scene import made_scene

TURN = 2 * np.pi
HEAD = """
dimensions: 3
gravity: [0, 0, 0]
run: {duration: 1 s, output: 0.1 s}
"""
READER = """
  other: {mass: 2, inertia: [0.1, 0.1, 0.1], position: [9, 0, 0]}
forces:
  reader: {type: force, i: other, force: [0, 0, "JOINT.angle"]}
"""


def rotor(name, x, degrees):
    return f"  {name}: {{mass: 2, inertia: [0.1, 0.1, 0.1], position: [{x}, 0, 0], orientation: {{euler: zxz, angles: [{degrees} deg, 0, 0]}}}}\n"


def solved(bodies, joints, reader, rest=""):
    text = HEAD + "bodies:\n" + bodies + READER.replace("JOINT", reader)[1:] + "joints:\n" + joints + rest
    return stiffmbs.run(scene_of(text)).channels


def scene_of(text):
    return made_scene(yaml.safe_load(text), (), "scene", lambda path: None)


HINGE = "  {0}: {{type: revolute, i: {1}, j: {{body: ground, point: [{2}, 0, 0]}}}}\n"


@pytest.mark.sampled(5)
@pytest.mark.parametrize("degrees", [-1000, -270, 200, 270, 540, 3000])
def test_a_force_reads_the_turn_of_a_drive(degrees):
    found = solved(
        rotor("a", 0, degrees),
        HINGE.format("hinge", "a", 0) + f'  motor: {{type: drive, joint: hinge, position: "{degrees}*pi/180 + t"}}\n',
        "hinge",
    )
    assert found["reader.fz"][[0, -1]] == pytest.approx(np.radians(degrees) + np.array([0, 1]))
    assert found["hinge.angle"] == pytest.approx(found["reader.fz"])


@pytest.mark.parametrize("degrees", [-1000, 270])
@pytest.mark.parametrize("rest", ["", "requests: {asked: hinge.angle}\n"])
def test_a_joint_set_at_the_start_has_the_turn_of_its_angle(degrees, rest):
    found = solved(
        rotor("a", 0, 0), HINGE.format("hinge", "a", 0), "hinge",
        f"at_start: {{tilt: {{type: drive, joint: hinge, position: {degrees} deg}}}}\n{rest}",
    )  # fmt: skip
    for name in ("reader.fz", "hinge.angle", *(["asked"] if rest else [])):
        assert found[name] == pytest.approx(np.radians(degrees), abs=1e-9), name


@pytest.mark.parametrize("order", [1, -1])
def test_a_train_of_gears_turns_with_its_drive(order):
    first = np.radians(270)
    angles = [first, -first / 0.3, first / 0.09]
    gears = [
        "  mesh_1: {type: gear, joint_1: h0, joint_2: h1, ratio: 0.3, offset: 0}\n",
        "  mesh_2: {type: gear, joint_1: h1, joint_2: h2, ratio: 0.3, offset: 0}\n",
    ]
    found = solved(
        "".join(rotor(f"b{k}", k, np.degrees(angle)) for k, angle in enumerate(angles)),
        "".join([*(HINGE.format(f"h{k}", f"b{k}", k) for k in range(3)), *gears[::order]])
        + '  motor: {type: drive, joint: h0, position: "1.5*pi + 0.1*t"}\n',
        "h2",
    )
    for k, angle in enumerate(angles):
        assert found[f"h{k}.angle"][[0, -1]] == pytest.approx(angle + angle / first * np.array([0, 0.1])), k
    assert found["reader.fz"] == pytest.approx(found["h2.angle"])


@pytest.mark.parametrize("turns", [-7.25, 2.5000001, 40.0])
def test_a_force_reads_the_turn_of_a_screw(turns):
    found = solved(
        rotor("a", 0, 360 * turns).replace("[0, 0, 0]", f"[0, 0, {0.01 * turns}]"),
        "  screw: {type: screw, i: a, j: ground, pitch: 0.01, offset: 0}\n",
        "screw",
    )
    assert found["reader.fz"] == pytest.approx(TURN * turns) and found["screw.angle"] == pytest.approx(TURN * turns)


def test_a_continued_run_keeps_the_turns_and_gives_them_to_new_elements(tmp_path):
    motor = '  motor: {type: drive, joint: hinge, position: "1.5*pi + 7*t"}\n'
    joints = "joints:\n" + HINGE.format("hinge", "a", 0) + motor
    bodies, other = "bodies:\n" + rotor("a", 0, 270), READER.splitlines()[1] + "\n"
    first = stiffmbs.run(scene_of(HEAD + bodies + other + joints))
    first.save(tmp_path / "first.npz")
    scene = scene_of(HEAD + bodies + READER[1:].replace("JOINT", "hinge") + joints + "requests: {asked: hinge.angle}\n")
    found = stiffmbs.run(scene, start_from=tmp_path / "first.npz").channels
    for name in ("reader.fz", "asked", "hinge.angle"):
        assert found[name][[0, -1]] == pytest.approx(1.5 * np.pi + 7 * np.array([1, 2])), name
