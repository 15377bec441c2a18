"""Bounds of actuators' forces and flags of MJCF files: accelerations are MuJoCo's."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot

mujoco = pytest.importorskip("mujoco")

ARM = """
<mujoco>
  <option gravity="0.1 0 -9.81" {option}><flag contact="disable" {flag}/></option>
  <worldbody>
    <body name="upper" pos="0 0 1" gravcomp="0.3">
      <joint name="a" axis="0 1 0" damping="0.7" stiffness="3" springref="20" frictionloss="0" {a}/>
      <geom type="capsule" size=".04" fromto="0 0 0 0.4 0 0"/>
      <body name="lower" pos="0.4 0 0">
        <joint name="b" axis="0 1 0.2" damping="0.3" {b}/>
        <geom type="capsule" size=".03" fromto="0 0 0 0.3 0 0.1"/>
        <body name="tip" pos="0.3 0 0.1"><joint name="c" type="slide" axis="0 0 1" damping="4" stiffness="20"/>
          <geom type="box" size=".05 .04 .03"/></body>
      </body>
    </body>
    <body name="flyer" pos="2 0 1"><joint name="free" type="free" damping="{free}"/><geom type="box" size=".1 .2 .3" pos="0.1 0 0"/></body>
  </worldbody>
  <tendon><fixed name="belt" stiffness="9" damping="0.4" springlength="0.1" {belt}><joint joint="a" coef="0.3"/><joint joint="b" coef="-0.5"/></fixed></tendon>
  <actuator>
    <motor name="m1" joint="a" gear="7" group="1" ctrllimited="true" ctrlrange="-1 1"/>
    <position name="m2" joint="a" kp="15" group="2"/>
    <motor name="m3" tendon="belt" gear="5" group="3" forcelimited="true" forcerange="{m3}"/>
    <motor name="m4" tendon="belt" gear="2" group="0"/>
    <motor name="m5" joint="c" group="4"/>
  </actuator>
</mujoco>
"""
PLAIN = dict.fromkeys(("option", "flag", "a", "b", "belt"), "") | {"free": "0", "m3": "-3 2.5"}
VARIANTS = {
    "plain": {},
    "joint range above": {"a": 'actuatorfrcrange="-2 1.5"'},
    "joint range below": {"a": 'actuatorfrcrange="-0.2 50"'},
    "joint of a tendon": {"b": 'actuatorfrcrange="-0.5 0.5"'},
    "both joints": {"a": 'actuatorfrcrange="-2 1.5"', "b": 'actuatorfrcrange="0.1 0.7"'},
    "range not limited": {"a": 'actuatorfrclimited="false" actuatorfrcrange="-2 1.5"'},
    "tendon": {"belt": 'actuatorfrcrange="-1 1.2"'},
    "tendon and joint": {"belt": 'actuatorfrcrange="-1 1.2"', "b": 'actuatorfrcrange="-0.4 0.4"'},
    "tendon and actuator": {"belt": 'actuatorfrcrange="-0.5 0.4"', "m3": "-0.6 0.5"},
    "group 0": {"option": 'actuatorgroupdisable="0"'},
    "groups 1 and 3": {"option": 'actuatorgroupdisable="1 3"'},
    "group nobody has": {"option": 'actuatorgroupdisable="9"'},
    "no springs": {"flag": 'spring="disable"'},
    "no dampers": {"flag": 'damper="disable"'},
    "neither": {"flag": 'spring="disable" damper="disable"'},
    "no gravity": {"flag": 'gravity="disable"'},
    "no actuation": {"flag": 'actuation="disable"'},
    "no bounds of inputs": {"flag": 'clampctrl="disable"'},
    "damped free body": {"free": "0.6"},
    "free body without dampers": {"free": "0.6", "flag": 'damper="disable"'},
}


def arm(tmp_path, variant):
    path = tmp_path / "arm.xml"
    path.write_text(ARM.format(**(PLAIN | VARIANTS[variant])))
    return path


@pytest.mark.sampled(9)
@pytest.mark.long
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("variant", VARIANTS)
def test_accelerations_are_those_of_mujoco(tmp_path, variant, sign):
    path = arm(tmp_path, variant)
    m = mujoco.MjModel.from_xml_path(str(path))
    d = mujoco.MjData(m)
    values = {"a": 0.4, "b": -0.7, "c": 0.05}, {"a": 1.1, "b": -0.6, "c": 0.3}
    for given, target in zip(values, (d.qpos, d.qvel), strict=True):
        for name, x in given.items():
            target[(m.joint(name).qposadr if target is d.qpos else m.joint(name).dofadr)[0]] = x
    inputs = dict(zip(("m1", "m2", "m3", "m4", "m5"), sign * np.array([1.6, 0.9, 1.4, -0.5, 3.0]), strict=True))
    speeds = [0.4, -0.2, 0.5, 0.7, -0.9, 0.3]
    d.qvel[m.joint("free").dofadr[0] :][:6] = speeds
    for name, u in inputs.items():
        d.ctrl[m.actuator(name).id] = u
    mujoco.mj_forward(m, d)
    known = load_robot(path).inputs
    changes = [(f"inputs.{name}_input", str(u)) for name, u in inputs.items() if f"{name}_input" in known]
    at_centre = np.array(speeds[:3]) + np.cross(speeds[3:], [0.1, 0, 0])
    changes += [("bodies.flyer.velocity", str(at_centre.tolist())), ("bodies.flyer.omega", str(speeds[3:]))]
    scene = load_robot(path, changes, coordinates=values[0], rates=values[1])
    run = stiffmbs.run(scene, duration=1e-6, output=1e-6, rtol=1e-10)
    for body in ("upper", "lower", "tip", "flyer"):
        k = m.body(body).id
        J, rate = np.zeros((3, m.nv)), np.zeros((3, m.nv))
        mujoco.mj_jac(m, d, J, None, d.xipos[k], k)
        mujoco.mj_jacDot(m, d, rate, None, d.xipos[k], k)
        found = [run[f"{body}.a{axis}"][0] for axis in "xyz"]
        assert found == pytest.approx(J @ d.qacc + rate @ d.qvel, rel=1e-8, abs=1e-8)


def test_actuators_that_are_switched_off_are_noted(tmp_path):
    assert any("are ignored: m1, m3" in note for note in load_robot(arm(tmp_path, "groups 1 and 3")).notes)


def test_a_total_of_several_actuators_on_one_side_of_zero_is_refused(tmp_path):
    path = arm(tmp_path, "plain")
    path.write_text(ARM.format(**(PLAIN | {"belt": 'actuatorfrclimited="true" actuatorfrcrange="0 1"'})))
    with pytest.raises(InputError, match=r"tendon belt: found the bounds 0 and 1 of the force of 2 actuators"):
        load_robot(path)


UNUSED = {
    ('name="a"', 'name="a" margin="0.2"'): "joint margin of a",
    (
        'name="a"',
        'name="a" solreflimit="0.1 1"',
    ): "(constraints are exact here, and limits are not enforced): joint solref_limit of a",
    ('name="upper"', 'name="upper" mocap="false" sleep="never"'): "body sleep of upper",
    (
        'name="m1"',
        'name="m1" user="3" forcelimited="true" forcerange="-1 1" lengthrange="0 1"',
    ): "actuator lengthrange of m1",
    ('size=".03"', 'size=".03" condim="4"'): "(contacts are left out): geom condim of geom_1",
    ('size=".03"', 'size=".03" rgba="1 0 0 1"'): "(graphics): geom rgba of geom_1",
    ("<flag", "<flag eulerdamp='disable'"): "(settings of MuJoCo's solver): flag EULERDAMP",
    ("<flag", "<flag invdiscrete='enable'"): "flag INVDISCRETE",
    ('gravity="', 'timestep="0.01" wind="1 0 0" gravity="'): "option timestep",
    ('gravity="0.1', 'wind="1 0 0" gravity="0.1'): "(the fluid is left out): option wind",
    ("</mujoco>", "<keyframe><key name='bent' time='1'/></keyframe></mujoco>"): "key of bent",
    ("</mujoco>", "<sensor><jointpos name='s' joint='a'/></sensor></mujoco>"): "sensor of s",
    ('name="free" type="free"', 'name="free" type="free" actuatorgravcomp="true"'): "joint actgravcomp of free",
}


@pytest.mark.parametrize("change", UNUSED)
def test_each_field_that_is_not_used_and_differs_from_its_default_is_noted(tmp_path, change):
    path = tmp_path / "arm.xml"
    path.write_text(ARM.format(**PLAIN).replace(*change, 1))
    notes = [note for note in load_robot(path).notes if note.startswith("not used")]
    assert UNUSED[change] in "; ".join(notes)


def test_a_file_of_which_all_is_used_has_no_such_note(tmp_path):
    assert not any(note.startswith("not used") for note in load_robot(arm(tmp_path, "plain")).notes)
