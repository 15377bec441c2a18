"""Equality constraints, dry friction and joints placed beyond half a turn, against MuJoCo's matrices with exact constraints."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.robots.load import load_robot

mujoco = pytest.importorskip("mujoco")

ROBOT = """<mujoco><compiler angle="radian"/><option jacobian="dense"><flag contact="disable"/></option>
<default><joint damping="0.1"/>
  <default class="stiff"><joint stiffness="2" springref="0.2" frictionloss="0.3"/><geom density="500"/></default></default>
<worldbody>
<body name="a" pos="0 0 1" euler="0.1 0.2 0.3"><joint name="j1" axis="0 1 0.2" armature="0.02"/>
  <geom type="capsule" size=".03" fromto="0 0 0 .3 .05 0"/>
  <body name="b" pos=".3 .05 0" childclass="stiff"><joint name="j2" axis="0.1 1 0"/><geom type="box" size=".2 .03 .05" pos=".15 0 0"/>
    <body name="d" pos="0.3 0 0"><joint name="j3" type="slide" axis="1 0 .1"/><geom type="sphere" size=".05"/></body></body></body>
<body name="c" pos=".7 0 1"><joint name="j4" axis="0 0 1" ref="0.3"/><geom type="ellipsoid" size=".1 .05 .07" pos="-.1 .1 0"/>
  <site name="s1" pos="-.1 .3 .2" euler="0.3 0.5 -0.2"/></body>
<body name="f" pos="1 1 1"><freejoint name="loose"/><geom type="box" size=".1 .2 .15" pos="0.1 0 0"/>
  <site name="s2" pos="-.4 -.7 .2" euler="0.3 0.5 -0.2"/></body>
</worldbody><equality>{}</equality></mujoco>"""
EQUALITIES = {
    "none": "",
    "point": '<connect body1="b" body2="c" anchor=".2 .1 0"/>',
    "point in the world": '<connect body1="b" anchor=".2 .1 0"/>',
    "points of sites": '<connect site1="s2" site2="s1"/>',
    "weld": '<weld body1="d" body2="f"/>',
    "weld to the world": '<weld body1="f"/>',
    "weld with an anchor": '<weld body1="f" body2="c" anchor="0.1 0.1 0"/>',
    "weld of sites": '<weld site1="s2" site2="s1"/>',
    "ratio": '<joint joint1="j1" joint2="j4" polycoef="0 -2 0 0 0"/>',
    "polynomial": '<joint joint1="j3" joint2="j4" polycoef="0 -0.2 0.5 0.3 -0.1"/>',
    "held": '<joint joint1="j2"/>',
    "inactive": '<joint joint1="j2" active="false"/>',
}


def constraint_rows(m, qpos):
    """Jacobian of the equality constraints at coordinates."""
    d = mujoco.MjData(m)
    d.qpos[:] = qpos
    mujoco.mj_forward(m, d)
    assert d.ne == 0 or np.abs(d.efc_pos[: d.ne]).max() < 1e-12, "the constraints hold as drawn"
    return d.efc_J.reshape(-1, m.nv)[: d.ne].copy()


def exact(m, d):
    """Velocities that the constraints allow, and accelerations with exact constraints and sliding friction."""
    J = constraint_rows(m, d.qpos)
    d.qvel[:] -= np.linalg.pinv(J) @ (J @ d.qvel)
    step, sides = 1e-5, []
    for side in (step, -step):
        there = d.qpos.copy()
        mujoco.mj_integratePos(m, there, d.qvel, side)
        e = mujoco.MjData(m)
        e.qpos[:] = there
        mujoco.mj_forward(m, e)
        sides.append(e.efc_J.reshape(-1, m.nv)[: e.ne].copy())
    bias = (sides[0] - sides[1]) / (2 * step) @ d.qvel
    mujoco.mj_forward(m, d)
    M = np.zeros((m.nv, m.nv))
    mujoco.mj_fullM(m, d, M)
    force = d.qfrc_passive + d.qfrc_actuator - d.qfrc_bias - m.dof_frictionloss * np.sign(d.qvel)
    whole = np.block([[M, J.T], [J, np.zeros((len(J), len(J)))]])
    return np.linalg.lstsq(whole, np.concatenate([force, -bias]), rcond=None)[0][: m.nv]


def accelerations_agree(tmp_path, text, coordinates=None):
    path = tmp_path / "robot.xml"
    path.write_text(text)
    m = mujoco.MjModel.from_xml_path(str(path))
    d, rng = mujoco.MjData(m), np.random.default_rng(1)
    for name, x in (coordinates or {}).items():
        d.joint(name).qpos[0] = x
    d.qvel[:] = rng.normal(size=m.nv)
    wanted = exact(m, d)
    hinges = [m.joint(k).name for k in range(m.njnt) if m.jnt_type[k] in (2, 3)]
    changes = []
    if m.nq > len(hinges):
        speeds, offset = d.joint("loose").qvel, m.body("f").ipos
        changes = [("bodies.f.velocity", str((speeds[:3] + np.cross(speeds[3:], offset)).tolist())),
                   ("bodies.f.omega", str(speeds[3:].tolist()))]  # fmt: skip
    rates = {name: float(d.joint(name).qvel[0]) for name in hinges}
    scene = load_robot(path, changes, coordinates=coordinates or {}, rates=rates)
    run = stiffmbs.run(scene, duration=1e-6, output=1e-6, rtol=1e-10)
    for body in range(1, m.nbody):
        J, rate = np.zeros((3, m.nv)), np.zeros((3, m.nv))
        mujoco.mj_jac(m, d, J, None, d.xipos[body], body)
        mujoco.mj_jacDot(m, d, rate, None, d.xipos[body], body)
        name = m.body(body).name
        found = [[run[f"{name}.{order}{axis}"][0] for axis in "xyz"] for order in ("", "a")]
        assert found[0] == pytest.approx(d.xipos[body], abs=1e-9)
        assert found[1] == pytest.approx(J @ wanted + rate @ d.qvel, rel=1e-7, abs=1e-7)


@pytest.mark.long
@pytest.mark.sampled(9)
@pytest.mark.parametrize("equality", EQUALITIES)
def test_accelerations_with_equalities_and_dry_friction(tmp_path, equality):
    accelerations_agree(tmp_path, ROBOT.format(EQUALITIES[equality]))


@pytest.mark.long
def test_a_weld_holds_its_anchor_as_drawn(tmp_path):
    accelerations_agree(tmp_path, ROBOT.format(EQUALITIES["weld with an anchor"]))


TURNED = """<mujoco><compiler angle="radian"/><option jacobian="dense"><flag contact="disable"/></option><worldbody>
<body name="a"><joint name="h" axis="0 1 0" stiffness="3" springref="0.4" ref="0.3" armature="0.2"/>
  <geom type="capsule" size=".03" fromto="0 0 0 .3 .05 0"/>
  <body name="b" pos=".3 .05 0"><joint name="k" axis="0 1 0.3"/><geom type="capsule" size=".03" fromto="0 0 0 .3 .05 0"/></body></body>
</worldbody><actuator><position joint="k" kp="5"/></actuator>{}</mujoco>"""


@pytest.mark.long
@pytest.mark.parametrize(
    "h", [4.0, *(pytest.param(x, marks=pytest.mark.long) for x in (0.3 - np.pi, 0.3 + 3 * np.pi, -9.0))]
)
def test_springs_and_servos_count_the_turns_at_which_a_joint_is_placed(tmp_path, h):
    """They took the coordinate within half a turn."""
    accelerations_agree(tmp_path, TURNED.format(""), {"h": h, "k": -h})


@pytest.mark.long
@pytest.mark.parametrize("h", [4.0, -7.0])
def test_couplings_count_the_turns_at_which_joints_are_placed(tmp_path, h):
    tie = '<equality><joint joint1="k" joint2="h" polycoef="0.2 -2 0 0 0"/></equality>'
    accelerations_agree(tmp_path, TURNED.format(tie), {"h": h, "k": 0.2 - 2 * (h - 0.3)})
