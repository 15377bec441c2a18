"""MJCF files: accelerations against MuJoCo's, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.robots.load import convert_robot, load_robot

pytest.importorskip("mujoco")
from .mujoco_oracle import compiled, worst_difference

EVERYTHING = """
<mujoco model="everything">
  <option gravity="0.3 -0.2 -9.7"/>
  <default><joint damping="0.1"/></default>
  <worldbody>
    <geom type="plane" size="5 5 .1"/>
    <body name="cart" pos="0 0 1" euler="10 20 30">
      <joint name="slider" type="slide" axis="1 2 0" stiffness="50" springref="0.2" armature="0.7" ref="0.1"/>
      <geom type="box" size=".2 .1 .05" pos="0.05 0 0"/>
      <body name="crank" pos="0.1 0 -0.1" gravcomp="0.4">
        <joint name="pitch" axis="0 1 0" pos="0 0 0.02" armature="0.03" ref="20" stiffness="3" springref="-5"/>
        <joint name="roll" axis="1 0 0.3"/>
        <geom type="capsule" size=".04" fromto="0 0 0 0.3 0.1 0"/>
        <site name="held" pos="0.3 0.1 0"/>
        <body name="plate" pos="0.3 0.1 0"><geom type="box" size=".05 .02 .03"/>
          <body name="tool" pos="0.02 0 0"/></body>
        <body name="bob" pos="0.3 0.1 0">
          <joint name="socket" type="ball" damping="0.2" stiffness="1.5"/>
          <geom type="ellipsoid" size=".1 .05 .07" pos="0 0 -0.2"/>
        </body>
      </body>
    </body>
    <body name="flyer" pos="2 0 3"><freejoint name="free"/><geom type="box" size=".1 .2 .3"/></body>
  </worldbody>
  <tendon>
    <fixed name="belt" stiffness="20" damping="0.5" springlength="0.05"><joint joint="pitch" coef="0.3"/><joint joint="roll" coef="-0.2"/></fixed>
  </tendon>
  <actuator>
    <motor name="push" joint="slider" gear="30" ctrllimited="true" ctrlrange="-0.3 0.3"/>
    <position name="servo" joint="pitch" kp="40" kv="2" gear="1.5"/>
    <velocity name="spin" joint="roll" kv="3"/>
    <motor name="pull" tendon="belt" gear="4"/>
    <general name="drive" joint="slider" gainprm="5" biasprm="0.2 -3 -0.7" gaintype="affine" biastype="affine" forcelimited="true" forcerange="-1 1"/>
  </actuator>
</mujoco>
"""


def _file(tmp_path, text):
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return path


def _public(name):
    gymnasium = pytest.importorskip("gymnasium")
    return Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets" / f"{name}.xml"


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1])
def test_accelerations_with_every_kind_of_joint_and_actuator(tmp_path, seed):
    path = _file(tmp_path, EVERYTHING)
    assert worst_difference(path, compiled(EVERYTHING), seed) < 1e-6


@pytest.mark.long
@pytest.mark.parametrize("name", [pytest.param("reacher", marks=pytest.mark.long), "inverted_double_pendulum"])
def test_accelerations_of_public_models(name):
    assert worst_difference(_public(name), compiled(_public(name)), 3) < 1e-9


@pytest.mark.sampled(10)
@pytest.mark.long
@pytest.mark.parametrize("name", ["ant", "half_cheetah", "humanoid", "pusher_v5", "walker2d_v5", "swimmer"])
def test_accelerations_of_larger_public_models(name):
    """Bodies without mass between the joints of one link leave 2e-7 of the humanoid's."""
    for seed in range(3):
        assert worst_difference(_public(name), compiled(_public(name)), seed) < 1e-6


@pytest.mark.long
def test_a_run_against_mujoco(tmp_path):
    """Half a second of the same motion; MuJoCo by RK4 with steps of 0.1 ms."""
    import mujoco

    m = compiled(EVERYTHING)
    m.opt.timestep, m.opt.integrator = 1e-4, mujoco.mjtIntegrator.mjINT_RK4
    d = mujoco.MjData(m)
    mujoco.mj_step(m, d, nstep=5000)
    run = stiffmbs.run(load_robot(_file(tmp_path, EVERYTHING)), duration=0.5, output=0.5, rtol=1e-9)
    for name in ("cart", "crank", "bob", "flyer"):
        found = [run[f"{name}.{axis}"][-1] for axis in "xyz"]
        np.testing.assert_allclose(found, d.body(name).xipos, atol=1e-6, err_msg=name)


def test_filters_and_integrators_are_states(tmp_path):
    text = """<mujoco><worldbody><body name="arm"><joint name="hinge"/><geom type="capsule" size=".1" fromto="0 0 0 1 0 0"/></body></worldbody>
    <option gravity="0 0 0"/><actuator><general name="lagging" joint="hinge" dyntype="filterexact" dynprm="0.2" gainprm="7"/></actuator></mujoco>"""
    path = _file(tmp_path, text)
    inertia = float(compiled(text).dof_M0[0])
    scene = load_robot(path, [("inputs.lagging_input", "0.5")])
    run = stiffmbs.run(scene, duration=1, output=0.5, rtol=1e-10)
    t = np.array([0.5, 1.0])
    expected = 7 * 0.5 / inertia * (t - 0.2 * (1 - np.exp(-t / 0.2)))  # of 7*0.5*(1 - exp(-t/0.2)) = I dw/dt
    np.testing.assert_allclose(run["arm.wz"][1:], expected, rtol=1e-7)


CLOSED = """<mujoco><worldbody>
<body name="a"><joint name="first" axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 .3 0 0"/>
  <body name="b" pos=".3 0 0"><joint name="second" axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 0 0 -.4"/></body></body>
<body name="c" pos=".5 0 -.4"><joint name="third" axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 -.2 0 0"/></body>
</worldbody><equality>{}</equality></mujoco>"""


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize(
    ("equality", "freedom"),
    [
        ('<connect name="tie" body1="b" body2="c" anchor="0 0 -.4"/>', 1),
        ('<weld name="tie" body1="b" body2="c"/>', 0),
        pytest.param(
            '<joint name="tie" joint1="first" joint2="second" polycoef="0 -2 0 0 0"/>', 2, marks=pytest.mark.long
        ),
        ('<joint name="tie" joint1="first" joint2="second" polycoef="0 -2 0.5 0 0"/>', 2),
        ('<joint name="tie" joint1="third"/>', 2),
        ('<joint name="tie" joint1="third" active="false"/>', 3),
    ],
)
def test_equality_constraints_close_loops(tmp_path, equality, freedom):
    report = stiffmbs.check(load_robot(_file(tmp_path, CLOSED.format(equality))))
    assert report.degrees_of_freedom == freedom


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '<motor name="push" joint="slider"',
            '<motor name="push" joint="socket"',
            "actuator push: .*expected a hinge or slide",
        ),
        ('type="ball" damping="0.2"', 'type="ball" armature="0.2"', "joint socket: .*armature of a ball joint"),
        (
            '<velocity name="spin" joint="roll" kv="3"/>',
            '<muscle name="spin" joint="roll" lengthrange="0 1"/>',
            "actuator spin: .*muscle",
        ),
        ("<worldbody>", "<wordbody>", "MuJoCo refuses the file"),
        ('<velocity name="spin" joint="roll" kv="3"/>', '<motor name="spin" site="held"/>', "actuator spin: .*site"),
    ],
)
def test_what_makes_no_scene_is_named(tmp_path, old, new, message):
    assert old in EVERYTHING
    with pytest.raises(InputError, match=message):
        load_robot(_file(tmp_path, EVERYTHING.replace(old, new)))


def test_the_text_runs_as_the_file_does(tmp_path):
    path = _file(tmp_path, EVERYTHING)
    scene = stiffmbs.read_scene(convert_robot(path, coordinates={"pitch": 0.3}))
    assert scene.bodies == load_robot(path, coordinates={"pitch": 0.3}).bodies
    with pytest.raises(InputError, match="found the joint elbow, expected one of pitch, roll, slider"):
        convert_robot(path, coordinates={"elbow": 0.3})


def test_a_body_with_a_valid_name_keeps_it(tmp_path):
    """The other one, with a sign that names of scenes do not have, gets a suffix, whichever comes first."""
    text = """<mujoco><worldbody><body name="left-arm"><joint/><geom size=".1" pos="1 0 0" mass="2"/>
    <body name="left_arm"><joint axis="1 0 0"/><geom size=".1" pos="0 1 0" mass="3"/></body></body></worldbody></mujoco>"""
    bodies = load_robot(_file(tmp_path, text)).bodies
    assert {name: body.mass for name, body in bodies.items()} == {"left_arm_link": 2, "left_arm": 3}


def test_limits_and_contacts_are_told(tmp_path):
    text = EVERYTHING.replace('name="roll" axis="1 0 0.3"', 'name="roll" axis="1 0 0.3" limited="true" range="-30 40"')
    notes = load_robot(_file(tmp_path, text)).notes
    assert any("contacts" in note for note in notes)
    assert any("roll -0.523599 .. 0.698132 rad" in note for note in notes)


@pytest.mark.parametrize("counts", [("100000000",), ("1e5",), ("300", "300")])
def test_a_great_many_copies_are_refused_at_once(tmp_path, counts):
    inner = '<body><joint type="hinge"/><geom size="0.1"/></body>'
    for count in counts:
        inner = f'<replicate count="{count}" offset="1 0 0">{inner}</replicate>'
    path = tmp_path / "a.xml"
    path.write_text(f"<mujoco><worldbody>{inner}</worldbody></mujoco>")
    with pytest.raises(InputError, match="copies by replicate"):
        load_robot(path)
