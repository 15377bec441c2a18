"""URDF files: accelerations against MuJoCo's, and messages."""

import re
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot

PANDA = Path(__file__).parents[1] / "data" / "robots" / "panda.urdf"
LINK = '<link name="{}"><inertial><origin xyz="0.1 0 0.2" rpy="0.3 0.2 0.1"/><mass value="2"/><inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial></link>'
ARM = f"""<robot name="arm"><link name="world"/>{LINK.format("base")}{LINK.format("upper arm")}{LINK.format("rail")}<link name="middle"/><link name="tip"/>
<joint name="mount" type="fixed"><parent link="world"/><child link="base"/><origin xyz="0 0 1" rpy="0.1 0 0"/></joint>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="middle"/><origin xyz="0 0.1 0.2" rpy="0.4 -0.2 1.1"/><axis xyz="0 1 1"/><limit lower="-1" upper="2" effort="50" velocity="1"/><dynamics damping="0.7" friction="0.0"/></joint>
<joint name="twist" type="continuous"><parent link="middle"/><child link="upper arm"/><origin xyz="0 0 0.1"/><axis xyz="1 0 0"/></joint>
<joint name="slide" type="prismatic"><parent link="upper arm"/><child link="rail"/><origin xyz="0.5 0 0" rpy="0 1 0"/><axis xyz="0 0 2"/><limit lower="0" upper="0.3" effort="20" velocity="1"/><dynamics damping="3"/></joint>
<joint name="end" type="fixed"><parent link="rail"/><child link="tip"/><origin xyz="0 0 0.3"/></joint>
</robot>"""


def _file(tmp_path, text):
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    return path


def _for_mujoco(text):
    """The text without shapes, whose meshes are not at hand, as MuJoCo reads it."""
    bare = re.sub(r"<(visual|collision)\b.*?</\1>|<mimic\b[^>]*/>", "", text, flags=re.DOTALL)
    return bare.replace("</robot>", '<mujoco><compiler fusestatic="false"/></mujoco></robot>')


@pytest.mark.parametrize("seed", [0, 1])
def test_accelerations_of_a_public_robot(tmp_path, seed):
    pytest.importorskip("mujoco")
    from .mujoco_oracle import compiled, worst_difference

    text = re.sub(r"<mimic\b[^>]*/>", "", PANDA.read_text())
    m = compiled(_for_mujoco(text))
    assert m.nv == 9
    assert worst_difference(_without_efforts(tmp_path, text), m, seed) < 1e-11


def test_accelerations_with_a_link_without_mass(tmp_path):
    """MuJoCo takes none between two joints; one of a millionth of the mass stands for it there."""
    pytest.importorskip("mujoco")
    from .mujoco_oracle import compiled, worst_difference

    small = '<link name="middle"><inertial><mass value="1e-7"/><inertia ixx="1e-9" ixy="0" ixz="0" iyy="1e-9" iyz="0" izz="1e-9"/></inertial></link>'
    m = compiled(_for_mujoco(ARM.replace('<link name="middle"/>', small)))
    assert worst_difference(_without_efforts(tmp_path, ARM), m, 2) < 1e-6


def _without_efforts(tmp_path, text):
    """MuJoCo makes no actuators of a URDF."""
    return _file(tmp_path, re.sub(r'effort="[^"]*"', 'effort="0"', text))


def test_efforts_are_inputs(tmp_path):
    """An effort at the slide alone accelerates it along its axis by force over mass, as gravity is off."""
    path = _file(tmp_path, ARM)
    assert list(load_robot(path).inputs) == ["shoulder_input", "slide_input"]
    scene = load_robot(path, [("inputs.slide_input", "25"), ("gravity", "[0, 0, 0]")])
    run = stiffmbs.run(scene, duration=1e-3, output=1e-3)
    assert abs(run["slide_drive.fx"][0]) < 20 and np.linalg.norm(
        [run[f"slide_drive.f{axis}"][0] for axis in "xyz"]
    ) == pytest.approx(20), "bounded by the effort of the limit"


def test_transmissions_say_what_is_driven(tmp_path):
    given = '<transmission name="t"><type>x</type><joint name="twist"/><actuator name="motor"/></transmission></robot>'
    assert list(load_robot(_file(tmp_path, ARM.replace("</robot>", given))).inputs) == ["twist_input"]


@pytest.mark.long
def test_mimicking_joints_are_coupled():
    scene = load_robot(PANDA, coordinates={"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02})
    run = stiffmbs.run(scene, duration=0.2, output=0.1, rtol=1e-9)
    hand, left, right = (
        np.array([run[f"panda_{part}.{axis}"] for axis in "xyz"]) for part in ("hand", "leftfinger", "rightfinger")
    )
    np.testing.assert_allclose(np.linalg.norm(left - hand, axis=0), np.linalg.norm(right - hand, axis=0), atol=1e-8)


def test_joints_that_move_no_mass_stay_where_they_are(tmp_path):
    text = ARM.replace('name="end" type="fixed"', 'name="end" type="revolute"')
    assert any("move no mass stay where they are: end" in note for note in load_robot(_file(tmp_path, text)).notes)


def test_planar_and_floating_joints(tmp_path):
    planar = ARM.replace('name="twist" type="continuous"', 'name="twist" type="planar"')
    assert stiffmbs.check(load_robot(_file(tmp_path, planar))).degrees_of_freedom == 5
    floating = ARM.replace('name="twist" type="continuous"', 'name="twist" type="floating"')
    assert "upper_arm" in load_robot(_file(tmp_path, floating)).bodies


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<parent link="rail"/>', '<parent link="rial"/>', "joint end: found the parent rial, expected a link of the file"),
        ('type="prismatic"', 'type="slider"', "joint slide: found the type slider, expected one of revolute"),
        ('<axis xyz="1 0 0"/>', '<axis xyz="0 0 0"/>', "joint twist: found an axis of length 0"),
        ('<axis xyz="1 0 0"/>', '<axis xyz="1 0"/>', "joint twist: found axis='1 0', expected three numbers"),
        ('<mass value="2"/>', '<mass value="two"/>', "link base: found value='two', expected a number"),
        ('<parent link="world"/>', '<parent link="tip"/>', "closed chain|without a parent joint"),
        ('<link name="tip"/>', '<link name="tip"/><link name="tip"/>', "found two links tip"),
        ("</robot>", "", "no well-formed XML"),
        ('ixx="0.02"', 'ixx="${mass}"', "run xacro"),
        ('ixx="0.02"', 'ixx="-0.02"', "link .*expected none below 0"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(tmp_path, old, new, message):
    assert old in ARM
    with pytest.raises(InputError, match=message):
        load_robot(_file(tmp_path, ARM.replace(old, new)))


FAR = """<robot name="r"><link name="base"/><link name="arm"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="{inertia}" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="h" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="{place} 0 0"/><axis xyz="0 1 0"/></joint></robot>"""


@pytest.mark.parametrize(
    ("place", "inertia"), [("1e160", "1"), ("-1e160", "1"), ("1e308", "1"), ("0", "1e308"), ("0", "1.7e308")]
)
@pytest.mark.filterwarnings("error")
def test_numbers_beyond_all_bounds_are_refused(tmp_path, place, inertia):
    path = tmp_path / "far.urdf"
    path.write_text(FAR.format(place=place, inertia=inertia))
    with pytest.raises(stiffmbs.InputError, match=r"found (numbers|moments of inertia|1e\+308)"):
        stiffmbs.load_scene(path)


PAIR = """<robot name="pair">
  <link name="base"/>
  <link name="one"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="two"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="three"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="c" type="{kind}"><parent link="base"/><child link="three"/><axis xyz="0 0 1"/><mimic joint="b" multiplier="2" offset="-0.1"/>{limit}</joint>
  <joint name="b" type="{kind}"><parent link="base"/><child link="two"/><axis xyz="0 1 0"/><mimic joint="a" multiplier="-1.5" offset="0.2"/>{limit}</joint>
  <joint name="a" type="{kind}"><parent link="base"/><child link="one"/><axis xyz="1 0 0"/>{limit}</joint>
</robot>"""


@pytest.mark.parametrize(
    ("given", "rates", "expected"),
    [
        ({}, {}, (0, 0.2, 0.3)),
        ({"a": 0.4}, {"a": 1.0}, (0.4, -0.4, -0.9)),
        ({"b": 0.5}, {}, (-0.2, 0.5, 0.9)),
        ({"c": 0.9}, {}, (-0.2, 0.5, 0.9)),
    ],
)
@pytest.mark.parametrize("kind", ["continuous", "prismatic"])
def test_joints_that_mimic_others_start_at_their_offset(tmp_path, kind, given, rates, expected):
    """The driver keeps its coordinate; the assembly does not share the offset."""
    limit = '<limit lower="-9" upper="9" effort="1" velocity="1"/>' if kind == "prismatic" else ""
    (tmp_path / "pair.urdf").write_text(PAIR.format(kind=kind, limit=limit))
    scene = load_robot(tmp_path / "pair.urdf", coordinates=given, rates=rates)
    found = stiffmbs.run(scene, duration=0.01, points=2)
    channel = "angle" if kind == "continuous" else "displacement"
    for name, value in zip("abc", expected, strict=True):
        assert found[f"{name}.{channel}"][0] == pytest.approx(value, abs=1e-9)
    if rates:
        assert [float(found[f"{name}.{channel}_rate"][0]) for name in "abc"] == pytest.approx([1, -1.5, -3])
