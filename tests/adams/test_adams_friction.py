"""FRICTION statements against equations of their joints' one motion, with loads that are solved for by hand."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

from .trials.adams_oracle import euler
from .trials.adams_trials import played

G = 9.80665
TIMES = np.linspace(0, 0.4, 21)


def step5(x, x0, h0, x1, h1):
    z = min(max((x - x0) / (x1 - x0), 0), 1)
    return h0 + (h1 - h0) * z**3 * (10 + z * (6 * z - 15))


def coefficient(v, static, dynamic, slow, times=1.5):
    """Adams' curve over a speed: the static coefficient at one velocity, the dynamic one from a multiple of it on."""
    if abs(v) < slow:
        return step5(v, -slow, -static, slow, static)
    return np.sign(v) * step5(abs(v), slow, static, times * slow, dynamic)


def direction(v, slow):
    return step5(v, -slow, -1, slow, 1)


@pytest.mark.sampled(9)
@pytest.mark.long
@pytest.mark.parametrize("ratio", [0.0557, 0.01, 0.03, 0.08, 0.099, 0.101, 0.11, 0.12, 0.13, 0.145, 0.16])
def test_the_torque_of_a_ball_over_its_speed_is_that_of_a_run_of_adams(tmp_path, ratio):
    text = """ACCGRAV/KGRAV=-9.80665
MARKER/11, PART=1
PART/2, MASS=3, CM=21, IP=2e12,2e12,2e12, WX={speed}
MARKER/21, PART=2
JOINT/1, SPHERICAL, I=21, J=11
FRICTION/7, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, BALL_RADIUS=1, STICTION_TRANSITION_VELOCITY=0.1
"""
    found = played(tmp_path, text.format(speed=ratio), 0.4, rtol=1e-9)
    if ratio == 0.0557:
        assert coefficient(ratio, 0.4, 0.3, 0.1) / 0.4 == pytest.approx(0.848, abs=5e-4)  # as measured
    np.testing.assert_allclose(-found["FRICTION_7.tx"] / (3 * G), coefficient(ratio, 0.4, 0.3, 0.1), rtol=1e-6)


PENDULUM = """ACCGRAV/KGRAV=-9.80665
MARKER/11, PART=1, REULER=30D,70D,0D
PART/2, QG=0,0,0, REULER=30D,70D,0D, MASS=2, CM=21, IP=0.05,0.04,0.06, WZ=5
MARKER/21, PART=2, QP=0.3,0.1,0.05
MARKER/22, PART=2
JOINT/1, REVOLUTE, I=22, J=11
"""


def pendulum(torque):
    """Turn and speed of a body on an inclined axis; `torque(speed, force, moment)` on it, along the axis."""
    mass, axes = 2.0, euler(30, 70, 0)
    inertia, arm, g = np.diag([0.05, 0.04, 0.06]), np.array([0.3, 0.1, 0.05]), axes.T @ [0, 0, -G]
    z = np.array([0, 0, 1.0])

    def loads(angle, rate, gain):
        """Reaction force and moment at the hinge, in the body's axes."""
        c, s = np.cos(angle), np.sin(angle)
        weight = mass * np.array([c * g[0] + s * g[1], c * g[1] - s * g[0], g[2]])
        pull = mass * (np.cross(gain * z, arm) + np.cross(rate * z, np.cross(rate * z, arm)))
        moment = inertia @ z * gain + np.cross(rate * z, inertia @ z * rate) + np.cross(arm, pull - weight)
        return pull - weight, moment

    def rates(t, y):
        gain = 0.0
        for _ in range(12):  # loads hang on the acceleration, which hangs on friction
            _, resting = loads(*y, 0.0)
            gain = (torque(y[1], *loads(*y, gain)) - resting[2]) / (0.06 + mass * (arm[0] ** 2 + arm[1] ** 2))
        return [y[1], gain]

    return solve_ivp(rates, (0, TIMES[-1]), [0, 5], t_eval=TIMES, rtol=1e-11, atol=1e-12).y


@pytest.mark.long
def test_a_pin_rubs_by_force_thrust_moment_and_preload(tmp_path):
    text = """FRICTION/1, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, FRICTION_ARM=0.05, BENDING_REACTION_ARM=0.2
, PIN_RADIUS=0.1, STICTION_TRANSITION_VELOCITY=0.2, TRANSITION_VELOCITY_COEFFICIENT=2, MAX_STICTION_DEFORMATION=0.01
, FRICTION_TORQUE_PRELOAD=0.5, EFFECT=(STICTION:SLIDING), INPUTS=(PRELOAD:REACTION_FORCE:BENDING_MOMENT)
"""

    def torque(rate, force, moment):
        load = 0.1 * np.hypot(*force[:2]) + 0.05 * abs(force[2]) + 0.1 / 0.2 * np.hypot(*moment[:2])
        v = 0.1 * rate
        return -coefficient(v, 0.4, 0.3, 0.2, 2) * load - 0.5 * direction(v, 0.2)

    found = played(tmp_path, PENDULUM + text, 0.4, rtol=1e-9)
    _, rate = pendulum(torque)
    np.testing.assert_allclose(found["PART_2.wz"], rate, atol=2e-6)
    assert np.ptp(np.sign(rate)) and any(
        "FRICTION/1: below STICTION_TRANSITION_VELOCITY" in note for note in found.notes
    )


@pytest.mark.long
def test_only_named_inputs_press(tmp_path):
    text = "FRICTION/1, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, PIN_RADIUS=0.1, FRICTION_TORQUE_PRELOAD=9, INPUTS=(REACTION)\n"

    def torque(rate, force, moment):
        return -coefficient(0.1 * rate, 0.4, 0.3, 0.1) * (0.1 * np.hypot(*force[:2]) + abs(force[2]))

    found = played(tmp_path, PENDULUM + text.replace("PIN_R", "FRICTION_ARM=1, PIN_R"), 0.4, rtol=1e-9)
    np.testing.assert_allclose(found["PART_2.wz"], pendulum(torque)[1], atol=2e-6)


SLIDER = """ACCGRAV/KGRAV=-9806.65
MARKER/11, PART=1, REULER=0D,60D,0D
PART/2, QG=0,0,0, REULER=0D,60D,0D, MASS=2, CM=21, IP=5E4,5E4,5E4, {start}
MARKER/21, PART=2
MARKER/22, PART=2, QP=40,0,0
JOINT/1, {kind}, I=22, J=11
VTORQUE/1, I=21, JFLOAT=12, RM=11, TX=3000\\TY=-2000\\TZ=700
MARKER/12, PART=1, FLOATING
"""
HEAD = """in millimetres
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
"""
LAW = "FRICTION/1, JOINT=1, MU_STATIC=0.5, MU_DYNAMIC=0.2, STICTION_TRANSITION_VELOCITY=100, REACTION_ARM=50, INITIAL_OVERLAP=200"


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(("word", "growth"), [("CONSTANT", 0), ("INCREASE", 1), ("DECREASE", -1)])
def test_a_guide_rubs_by_force_moments_and_preload(tmp_path, word, growth):
    text = SLIDER.format(kind="TRANSLATIONAL", start="VY=-866.0254037844386, VZ=500")
    found = played(
        tmp_path, text + f"{LAW}, FRICTION_FORCE_PRELOAD=2, OVERLAP_DELTA={word}\n", 0.4, head=HEAD, rtol=1e-9
    )
    across, along = 2 * G * np.sin(np.pi / 3), -2 * G * np.cos(np.pi / 3)

    def rates(t, y):
        x, v = y
        gain = 0.0
        for _ in range(8):  # about marker I, 40 mm from the centre of mass, weight and inertia have arms
            moment = np.array([-3.0, 2.0 - 0.04 * (along - 2 * gain), -0.7 - 0.04 * across])
            load = across + np.hypot(*moment[:2]) / (0.2 + growth * x) + abs(moment[2]) / 0.05
            gain = (along - coefficient(v, 0.5, 0.2, 0.1) * load - 2 * direction(v, 0.1)) / 2
        return [v, gain]

    own = solve_ivp(rates, (0, 0.4), [0, 1], t_eval=TIMES, rtol=1e-11, atol=1e-12).y
    z = euler(0, 60, 0)[:, 2]
    np.testing.assert_allclose(found["PART_2.vz"] * z[2] + found["PART_2.vy"] * z[1], own[1], atol=2e-6)
    assert own[1][-1] < 0.1 < own[1][0]


@pytest.mark.long
def test_a_sleeve_rubs_against_the_velocity_of_its_surface(tmp_path):
    text = SLIDER.format(kind="CYLINDRICAL", start="VY=-866.0254037844386, VZ=500, WZ=20")
    found = played(
        tmp_path,
        text + LAW.replace("REACTION_ARM=50", "PIN_RADIUS=30, FRICTION_FORCE_PRELOAD=2, FRICTION_TORQUE_PRELOAD=90")
        + "\n",
        0.4, head=HEAD, rtol=1e-9,
    )  # fmt: skip
    loads = np.array([[found[f"JOINT_1.{c}{axis}"] for axis in "xyz"] for c in "ft"])  # (2, 3, n)
    axes = euler(0, 60, 0)
    force, moment = np.einsum("ij,cit->cjt", axes, loads)
    z = axes[:, 2]
    v = found["PART_2.vz"] * z[2] + found["PART_2.vy"] * z[1]
    w = found["PART_2.wz"] * 0.03
    speed = np.hypot(v, w)
    load = np.hypot(*force[:2]) + np.hypot(*moment[:2]) / 0.2
    size = np.array([coefficient(s, 0.5, 0.2, 0.1) for s in speed]) * load
    way = np.array([direction(s, 0.1) for s in speed])
    np.testing.assert_allclose(
        found["FRICTION_1.fz"] * z[2] + found["FRICTION_1.fy"] * z[1],
        -(size + 2 * way) * v / speed,
        rtol=1e-4,
        atol=1e-4,
    )
    twist = found["FRICTION_1_torque.tz"] * z[2] + found["FRICTION_1_torque.ty"] * z[1]
    np.testing.assert_allclose(twist, -(0.03 * size + 0.09 * way) * w / speed, rtol=1e-4, atol=1e-5)


@pytest.mark.long
def test_a_ball_is_braked_against_its_angular_velocity(tmp_path):
    text = """ACCGRAV/KGRAV=-9.80665
MARKER/11, PART=1, REULER=20D,30D,40D
PART/2, MASS=3, CM=21, IP=0.02,0.02,0.02, WX=3, WY=2, WZ=-6
MARKER/21, PART=2
JOINT/1, SPHERICAL, I=21, J=11
FRICTION/7, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, BALL_RADIUS=0.02, FRICTION_TORQUE_PRELOAD=0.02
, STICTION_TRANSITION_VELOCITY=0.04, EFFECT=SLIDING
"""
    found = played(tmp_path, text, 0.4, rtol=1e-9)

    def rates(t, y):
        v = 0.02 * y[0]
        return [-(coefficient(v, 0.3, 0.3, 0.04) * 3 * G * 0.02 + 0.02 * direction(v, 0.04)) / 0.02]

    own = solve_ivp(rates, (0, 0.4), [7], t_eval=TIMES, rtol=1e-11, atol=1e-12).y[0]
    spin = np.array([found[f"PART_2.w{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(spin, np.outer([3 / 7, 2 / 7, -6 / 7], own), atol=1e-6)


@pytest.mark.parametrize(
    ("friction", "message"),
    [
        ("JOINT=2, MU_STATIC=1, MU_DYNAMIC=1", "found JOINT = 2, expected the number of a JOINT"),
        ("JOINT=1, MU_STATIC=1", "found no MU_DYNAMIC, expected a coefficient of friction"),
        ("JOINT=1, MU_STATIC=1, MU_DYNAMIC=-1", "found MU_DYNAMIC = -1, expected a number of zero or more"),
        ("JOINT=1, MU_STATIC=1, MU_DYNAMIC=1, FORMULATION=LUGRE", "found FORMULATION = LUGRE, expected ORIGINAL"),
        ("JOINT=1, MU_STATIC=1, MU_DYNAMIC=1, EFFECT=STICTION", "found EFFECT = STICTION, expected ALL or SLIDING"),
        (
            "JOINT=1, MU_STATIC=1, MU_DYNAMIC=1, TRANSITION_VELOCITY_COEFFICIENT=0.5",
            "found TRANSITION_VELOCITY_COEFFICIENT = 0.5, expected a number above 1",
        ),
        ("JOINT=1, MU_STATIC=1, MU_DYNAMIC=1, MAX_FRICTION_FORCE=1", "found MAX_FRICTION_FORCE, expected friction without"),
        ("JOINT=1, MU_STATIC=1, MU_DYNAMIC=1, INPUTS=(X)", "found INPUTS = \\(X\\), expected ALL, NONE or PRELOAD"),
    ],
)  # fmt: skip
def test_what_is_not_read_is_said(friction, message):
    head = "a\nPART/1, GROUND\n"
    with pytest.raises(InputError, match=message):
        read_adams(head + PENDULUM + f"FRICTION/1, {friction}\nEND\n")


def test_without_its_joint_there_is_no_friction(tmp_path):
    (tmp_path / "trial.acf").write_text("DEACTIVATE/JOINT, ID=1\nSIMULATE/DYNAMICS, END=0.1, STEPS=1\n")
    (tmp_path / "trial.adm").write_text(
        "a\nPART/1, GROUND\n" + PENDULUM + "FRICTION/1, JOINT=1, MU_STATIC=1, MU_DYNAMIC=1\nEND\n"
    )
    assert not stiffmbs.load_scene(tmp_path / "trial.adm").forces


def test_friction_of_old_joints_is_refused_where_it_acts():
    text = PENDULUM.replace("JOINT/1, REVOLUTE", "JOINT/1, REVOLUTE, {}DELTA_V=1, INNER_RADIUS=2, MAXIMUM_DEF=0.01")
    with pytest.raises(
        InputError, match=r"JOINT/1: found MU_STAT_ROT = 0\.1, friction of old versions with an unpublished law"
    ):
        read_adams("a\nPART/1, GROUND\n" + text.format("MU_STAT_R=0.1, MU_DYN_ROT=0, ") + "END\n")
    for off in ("MU_STAT_ROT=0, MU_DYN_ROT=0, ", "FRICTION=OFF, MU_STAT_ROT=0.1, "):
        assert not read_adams("a\nPART/1, GROUND\n" + text.format(off) + "END\n").forces


@pytest.mark.long
def test_friction_is_the_same_from_either_marker(tmp_path):
    law = "FRICTION/1, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, FRICTION_ARM=0.05, PIN_RADIUS=0.1, FRICTION_TORQUE_PRELOAD=0.5\n"
    one = played(tmp_path, PENDULUM + law, 0.4, rtol=1e-9)
    other = played(tmp_path, PENDULUM.replace("I=22, J=11", "I=11, J=22") + law, 0.4, rtol=1e-9)
    np.testing.assert_allclose(other["PART_2.wz"], one["PART_2.wz"], atol=1e-7)
    np.testing.assert_allclose(other["FRICTION_1.tz"], -one["FRICTION_1.tz"], atol=1e-6)
