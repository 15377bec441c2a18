"""Tendons through space of MJCF files: accelerations against MuJoCo's, and what is refused."""

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot

pytest.importorskip("mujoco")
from .mujoco_oracle import by_mujoco, by_stiffmbs, compiled

ROBOT = """<mujoco><compiler angle="radian"/><option><flag contact="disable"/></option><worldbody>
<site name="w0" pos="0 0.1 0.6"/><site name="w1" pos="0.5 0.3 0.5"/>
<body name="a"><joint name="h" axis="0 1 0"/><geom type="capsule" size=".03" fromto="0 0 0 .3 .05 0"/><geom name="drum" type="sphere" size=".02"/>
  <site name="a0" pos=".2 .05 .04"/><site name="a1" pos=".25 .05 .04"/>
  <body name="b" pos=".3 .05 0"><joint name="k" axis="0 1 0.3"/><geom type="capsule" size=".03" fromto="0 0 0 .3 .05 0"/>
    <site name="b0" pos=".2 .01 .05"/></body></body>
<body name="f" pos="1 1 1"><joint name="s" type="slide" axis="1 2 0"/><geom type="box" size=".1 .2 .15" pos="0.1 0 0"/>
  <site name="f0" pos=".1 -.2 .1"/></body></worldbody>
<tendon>
  <spatial name="t1" stiffness="30" damping="2" springlength="0.9"><site site="w0"/><site site="a0"/><site site="a1"/><site site="b0"/></spatial>
  <spatial name="t2" stiffness="10" damping=".3"><site site="w1"/><site site="b0"/>
    <pulley divisor="2"/><site site="f0"/><site site="a1"/><pulley divisor="4"/><site site="f0"/><site site="b0"/></spatial>
</tendon>
<actuator><motor name="m1" tendon="t1" gear="3"/><position name="m2" tendon="t2" kp="20" gear="2" forcerange="-9 9"/>
  <general name="m3" tendon="t2" gainprm="-4" biastype="affine" biasprm="1 -2 -.1"/></actuator></mujoco>"""


def _file(tmp_path, text):
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return path


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("more", ["", 'actuatorfrcrange="-1.5 1.2"'])
def test_accelerations_with_tendons_through_space(tmp_path, more):
    """Along segments between two bodies, with those within one counted in the length; pulleys share the force."""
    text = ROBOT.replace('name="t2"', f'name="t2" {more}')
    state = {"h": 0.3, "k": -0.5, "s": 0.1}, {"h": 1.1, "k": -0.7, "s": 0.4}, np.array([0.3, -0.2, 0.5])
    wanted, found = by_mujoco(compiled(text), *state), by_stiffmbs(_file(tmp_path, text), *state)
    for name in ("a", "b", "f"):
        assert found[name][1] == pytest.approx(wanted[name][1], rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<site site="a0"/><site site="a1"/>', '<geom geom="drum"/><site site="a1"/>', "m1: found a tendon that wraps around a geom"),
        ('name="k"', 'name="k" actuatorfrcrange="-1 1"', "m1: found a tendon through space and bounds .* on k"),
    ],
)  # fmt: skip
def test_what_makes_no_scene_is_named(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message):
        load_robot(_file(tmp_path, ROBOT.replace(old, new)))
