"""URDF files: what is not used is noted, and what other readers take is taken."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot

ROBOT = """<robot name="r">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <link name="hand">{hand}</link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5"/></joint>
  <joint name="wrist" type="{kind}"><parent link="arm"/><child link="hand"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>{wrist}</joint>
</robot>"""
MASS = '<inertial><mass value="1"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>'
LIMIT = '<limit lower="-1" upper="1" effort="5"/>'


def robot(tmp_path, hand=MASS, kind="revolute", wrist=LIMIT, **changes):
    text = ROBOT.format(hand=hand, kind=kind, wrist=wrist)
    for old, new in changes.get("replace", ()):
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    return path


def unused(path):
    return "; ".join(note for note in load_robot(path).notes if note.startswith("not used"))


def test_a_file_of_which_all_is_used_has_no_such_note(tmp_path):
    assert not unused(robot(tmp_path))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"wrist": LIMIT + '<safety_controller k_velocity="3"/>'}, "(limits are not held): joint <safety_controller> of wrist"),
        ({"wrist": LIMIT + '<calibration rising="0.1"/>'}, "joint <calibration> of wrist"),
        ({"wrist": LIMIT + '<dynamics damping="1" spring_stiffness="7"/>'}, "joint/dynamics spring_stiffness of wrist"),
        ({"kind": "continuous", "wrist": LIMIT}, "joint/limit lower of wrist"),
        ({"kind": "planar", "wrist": '<dynamics damping="1" friction="2"/>'}, "joint/dynamics friction of wrist"),
        ({"kind": "floating", "wrist": '<dynamics damping="1"/>'}, "joint <dynamics> of wrist"),
        ({"hand": MASS + "<visual><geometry/></visual>"}, "(shapes and contacts are left out): link <visual> of hand"),
        ({"hand": MASS + "<contact><stiffness value='3'/></contact>"}, "link <contact> of hand"),
        ({"hand": MASS.replace("<mass", "<density/><mass")}, "link/inertial <density> of hand"),
        ({"replace": [("</robot>", '<gazebo reference="arm"><mu1>3</mu1></gazebo></robot>')]}, "robot <gazebo>"),
        ({"replace": [("</robot>", '<drake:loop_joint name="l"/></robot>')]}, "robot <drake:loop_joint>"),
        ({"replace": [("</robot>", '<transmission name="t"><type>x</type><joint name="hinge"/><actuator name="m"/></transmission></robot>')]},
         "(actuators of transmissions are left out): transmission name of t, transmission <type> of t, transmission <actuator> of t"),
    ],
)  # fmt: skip
def test_what_is_not_used_is_noted(tmp_path, changes, said):
    assert said in unused(robot(tmp_path, **changes))


@pytest.mark.parametrize("moment", ["-2e-35", "-1e-20", "0", "-0.0", "1e-40"])
@pytest.mark.parametrize(
    "hand", ['<inertial><mass value="0"/>{}</inertial>', '<inertial><mass value="1"/>{}</inertial>']
)
def test_moments_that_rounding_has_left_are_none(tmp_path, hand, moment):
    inertia = f'<inertia ixx="{moment}" ixy="0" ixz="0" iyy="{moment}" iyz="0" izz="{moment}"/>'
    scene = load_robot(robot(tmp_path, hand=hand.format(inertia)))
    assert stiffmbs.run(scene, duration=0.01).outcome.name == "DONE"


@pytest.mark.parametrize("moment", ["-1e-3", "-1e-9"])
def test_moments_below_zero_are_refused(tmp_path, moment):
    inertia = (
        f'<inertial><mass value="1"/><inertia ixx="{moment}" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
    )
    with pytest.raises(InputError, match=r"link hand: found the principal moments of inertia -"):
        load_robot(robot(tmp_path, hand=inertia))


@pytest.mark.parametrize("kind", ["fixed", "revolute", "continuous"])
@pytest.mark.parametrize("mass", ["", '<mass value="0"/>'])
def test_a_link_with_inertia_and_no_mass_keeps_it(tmp_path, kind, mass):
    """An arm with its load locked: (I + m c^2) a = m g c with the inertia of both."""
    hand = f'<inertial>{mass}<inertia ixx="0" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.3"/></inertial>'
    scene = load_robot(robot(tmp_path, hand=hand, kind=kind, wrist="" if kind == "fixed" else LIMIT))
    run = stiffmbs.run(scene, duration=1e-6, output=1e-6)
    carried = 0.3 if kind == "fixed" else 0.0
    assert run["arm.wdy"][0] == pytest.approx(2 * 9.81 * 0.2 / (0.02 + 2 * 0.2**2 + carried), rel=1e-6)


@pytest.mark.parametrize(
    ("kind", "wrist", "said"),
    [
        ("fixed", '<mimic joint="hinge" multiplier="2"/>', "'mimic' has no effect on fixed joints: wrist"),
        ("fixed", '<mimic joint="nothing"/>', "'mimic' has no effect on fixed joints: wrist"),
        ("fixed", '<mimic/>' + LIMIT, "'mimic' has no effect on fixed joints: wrist"),
        ("revolute", LIMIT + '<mimic joint="hinge" multiplier="2"/>', ""),
    ],
)  # fmt: skip
def test_mimics_of_fixed_joints_are_left_out(tmp_path, kind, wrist, said):
    scene = load_robot(robot(tmp_path, kind=kind, wrist=wrist))
    assert not said or any(said in note for note in scene.notes)
    assert ("wrist_mimic" in scene.joints) == (kind != "fixed")


def test_a_joint_that_mimics_a_fixed_one_is_held_at_its_offset(tmp_path):
    path = robot(
        tmp_path, kind="fixed", wrist="", replace=[('effort="5"/>', 'effort="5"/><mimic joint="wrist" offset="0.25"/>')]
    )
    run = stiffmbs.run(load_robot(path, coordinates={"hinge": 0.25}), duration=0.1)
    assert np.ptp(run["arm.wy"]) < 1e-9


@pytest.mark.parametrize("prefix", ["drake", "gazebo", "my", "sensor"])
@pytest.mark.parametrize("place", ["robot", "link", "attribute"])
def test_prefixes_need_not_be_declared(tmp_path, prefix, place):
    replace = {
        "robot": ("</robot>", f"<{prefix}:x/></robot>"),
        "link": ('<link name="base"/>', f'<link name="base"><{prefix}:x/></link>'),
        "attribute": ('<robot name="r">', f'<robot name="r" {prefix}:version="2">'),
    }[place]
    assert f"{prefix}:" in unused(robot(tmp_path, replace=[replace]))
