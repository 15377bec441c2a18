"""Runs of Adams datasets against closed forms: every statement that holds or moves something."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs.adams.load import read_adams

from .metric_datasets import GRAVITY, HEAD, TWO, G, run


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    "statement, equations",
    [
        ("JOINT/1, REVOLUTE, I=21, J=1", 5),
        ("JOINT/1, TRANSLATIONAL, I=21, J=1", 5),
        ("JOINT/1, CYLINDRICAL, I=21, J=1", 4),
        ("JOINT/1, SPHERICAL, I=21, J=1", 3),
        ("JOINT/1, FIXED, I=21, J=1", 6),
        ("JOINT/1, HOOKE, I=21, J=1", 4),
        ("MARKER/22, PART=2, REULER=0,90D,0\nJOINT/1, UNIVERSAL, I=22, J=1", 4),
        ("JOINT/1, PLANAR, I=21, J=1", 3),
        ("JOINT/1, SCREW, I=21, J=1, PITCH=0.1", 1),
        ("MARKER/22, PART=2, REULER=0,180D,0\nJOINT/1, CONVEL, I=22, J=1", 4),
        ("MARKER/22, PART=2, QP=0,-0.2,0, REULER=90D,90D,0\nJOINT/1, RACKPIN, I=1, J=22, PD=0.4", 1),
        ("JPRIM/1, ATPOINT, I=21, J=1", 3),
        ("JPRIM/1, INLINE, I=21, J=1", 2),
        ("JPRIM/1, INPLANE, I=21, J=1", 1),
        ("JPRIM/1, ORIENTATION, I=21, J=1", 3),
        ("JPRIM/1, PARALLEL_AXES, I=21, J=1", 2),
        ("MARKER/22, PART=2, REULER=0,90D,0\nJPRIM/1, PERPENDICULAR, I=22, J=1", 1),
        ("GCON/1, FUNCTION=DX(21,1)+DY(21,1)", 1),
        ("GCON/1, FUNCTION=VX(21)-0.5*WZ(21)", 1),
        ("VARIABLE/1, FUNCTION=WZ(21)\nVARIABLE/2, FUNCTION=2*VARVAL(1)\nGCON/1, FUNCTION=DX(21)+VARVAL(2)", 1),
        ("MOTION/1, I=21, J=1, X, FUNC=TIME", 1),
        pytest.param("MOTION/1, I=21, J=1, B2, FUNC=TIME", 1, marks=pytest.mark.long),
    ],
)
def test_constraints_take_as_many_freedoms_as_in_adams(statement, equations):
    report = stiffmbs.check(read_adams(HEAD + TWO + statement + "\nEND"))
    assert (report.rank, report.degrees_of_freedom) == (equations, 12 - equations)


@pytest.mark.long
def test_a_linear_actuator_carries_weight_and_inertia():
    """1 kg on a guide at 45 degrees, led by 0.1 sin 5t along it: f = m (a + g sin 45)."""
    text = (
        GRAVITY
        + r"""MARKER/2, PART=1, REULER=0,45D,0
PART/4, MASS=1, CM=40, IP=0.1,0.1,0.1
MARKER/40, PART=4
MARKER/41, PART=4, REULER=0,45D,0
JOINT/1, TRANSLATIONAL, I=41, J=2
MOTION/1, JOINT=1, FUNCTION=0.1*SIN(5*TIME)
REQUEST/1, F2=MOTION(1,0,4,2)\F3=MOTION(1,0,1,0)\F4=DZ(41,2,2)\F6=VZ(41,2,2)\F7=ACCZ(41,2,2)\F8=JOINT(1,0,3,2)
"""
    )
    solution = run(text)
    s = 0.1 * np.sin(5 * solution.t)
    force = -25 * s + G * math.cos(math.pi / 4)
    np.testing.assert_allclose(solution["REQUEST_1.f2"], force, atol=1e-6)
    np.testing.assert_allclose(solution["REQUEST_1.f3"], np.abs(force), atol=1e-6)
    np.testing.assert_allclose(solution["REQUEST_1.f4"], s, atol=1e-9)
    np.testing.assert_allclose(solution["REQUEST_1.f6"], 0.5 * np.cos(5 * solution.t), atol=1e-7)
    np.testing.assert_allclose(solution["REQUEST_1.f7"], -25 * s, atol=1e-6)
    np.testing.assert_allclose(np.abs(solution["REQUEST_1.f8"]), G * math.sin(math.pi / 4), atol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["DISPLACEMENT, FUNC=8*TIME", "VELOCITY, FUNC=8", "ACCELERATION, FUNC=16"])
def test_a_motor_turns_many_times(kind):
    text = TWO + f"JOINT/1, REVOLUTE, I=21, J=1\nMOTION/1, JOINT=1, {kind}\nVARIABLE/1, FUNC=AZ(21,1)"
    solution = run(text, 3.0)
    angle = 8 * solution.t**2 if "ACCEL" in kind else 8 * solution.t
    np.testing.assert_allclose(solution["VARIABLE_1"], angle, atol=1e-5)
    torque = 0.2 * 16 if "ACCEL" in kind else 0.0
    np.testing.assert_allclose(solution["MOTION_1.tz"], torque, atol=1e-5)


@pytest.mark.long
@pytest.mark.parametrize(("order", "travel", "speed"), [("ACCELERATION", 0.02135, 0.065), ("VELOCITY", 0.065, 0.1)])
def test_a_slide_is_led_by_the_integral_of_a_step(order, travel, speed):
    """STEP from 0 at 0.2 s to 100 mm/s at 0.5 s: its integral at 1 s is 65 mm, twice integrated 21.35 mm."""
    text = f"""millimetres
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
PART/2, MASS=2, CM=20, IP=1,1,1
MARKER/20, PART=2
JOINT/1, TRANSLATIONAL, I=20, J=1
MOTION/1, JOINT=1, {order}, ICDISP=20, FUNCTION=STEP(TIME, 0.2, 0, 0.5, 100)
END
"""
    solution = stiffmbs.run(read_adams(text), duration=1.0, rtol=1e-9)
    assert solution["PART_2.z"][-1] == pytest.approx(0.02 + travel, abs=1e-8)
    assert solution["PART_2.vz"][-1] == pytest.approx(speed, abs=1e-8)


@pytest.mark.long
def test_a_sleeve_is_turned_and_pushed():
    text = (
        TWO
        + "JOINT/1, CYLINDRICAL, I=21, J=1\nMOTION/1, JOINT=1, ROT, FUNC=7*TIME\nMOTION/2, JOINT=1, TRANS, FUNC=TIME**2\n"
    )
    solution = run(text + "VARIABLE/1, FUNC=AZ(21,1)\nVARIABLE/2, FUNC=DZ(21,1,1)")
    np.testing.assert_allclose(solution["VARIABLE_1"], 7 * solution.t, atol=1e-7)
    np.testing.assert_allclose(solution["VARIABLE_2"], solution.t**2, atol=1e-8)
    np.testing.assert_allclose(solution["MOTION_2.fz"], 2 * 2, atol=1e-6)


@pytest.mark.long
def test_three_motors_lead_the_body_123_angles():
    """B1, B2, B3 against the axes of J: the body's quaternion is that of turns about x, the new y and the new z."""
    motions = "".join(f"MOTION/{k}, I=21, J=1, B{k}, FUNC={0.2 * k}+{0.3 * k}*TIME\n" for k in (1, 2, 3))
    solution = run(TWO + "JPRIM/1, ATPOINT, I=21, J=1\n" + motions)
    half = [(0.2 * k + 0.3 * k * solution.t) / 2 for k in (1, 2, 3)]
    (c1, c2, c3), (s1, s2, s3) = np.cos(half), np.sin(half)
    expected = [
        c1 * c2 * c3 - s1 * s2 * s3,
        s1 * c2 * c3 + c1 * s2 * s3,
        c1 * s2 * c3 - s1 * c2 * s3,
        c1 * c2 * s3 + s1 * s2 * c3,
    ]
    sign = np.sign(solution["PART_2.q0"][0] * expected[0][0])
    for k in range(4):
        np.testing.assert_allclose(solution[f"PART_2.q{k}"] * sign, expected[k], atol=1e-7)


@pytest.mark.long
def test_a_sleeve_that_a_motor_turns_starts_to_slide_as_its_joint_says():
    text = TWO + "JOINT/1, CYLINDRICAL, I=21, J=1, ICROT=20D, ICTRAN=0.1,3\nMOTION/1, JOINT=1, ROT, FUNC=7*TIME\n"
    solution = run(text + "VARIABLE/1, FUNC=AZ(21,1)")
    np.testing.assert_allclose(solution["VARIABLE_1"], 7 * solution.t, atol=1e-7)
    np.testing.assert_allclose(solution["PART_2.z"], 0.1 + 3 * solution.t, atol=1e-7)
    assert any("initial conditions of JOINT/1 are left out" in note for note in solution.notes)


GEARS = (
    TWO
    + """JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, REVOLUTE, {}
MARKER/14, PART=1, QP=0.25,0,0, REULER=0,90D,0
GEAR/1, JOINTS=1,2, CV=14
SFORCE/1, ROTATIONAL, I=21, J=1, FUNCTION=2
"""
)


@pytest.mark.long
@pytest.mark.parametrize("second", ["I=31, J=13", "I=13, J=31"])
def test_gears_share_a_torque(second):
    """Radii 0.25 and 0.75: w1 = -3 w2; 2 N m on wheel 1 turns it with 2/(I1 + I2/9)."""
    solution = run(GEARS.format(second))
    rate = 2 / (0.2 + 0.4 / 9) * solution.t
    np.testing.assert_allclose(solution["PART_2.wz"], rate, atol=1e-6)
    np.testing.assert_allclose(solution["PART_3.wz"], -rate / 3, atol=1e-6)


@pytest.mark.long
def test_couplers_share_a_force():
    """A drum of 0.2 m with a rope: s = 0.2 angle."""
    text = (
        TWO
        + "JOINT/1, REVOLUTE, I=21, J=1\nJOINT/2, TRANSLATIONAL, I=31, J=13\nCOUPLER/1, JOINTS=2,1, TYPE=T:R, SCALES=1,-0.2\n"
    )
    solution = run(text + GRAVITY)
    fall = -G * 3 / (3 + 0.2 / 0.2**2)
    np.testing.assert_allclose(solution["PART_3.vz"], fall * solution.t, atol=1e-6)
    np.testing.assert_allclose(solution["PART_2.wz"], fall * solution.t / 0.2, atol=1e-5)


@pytest.mark.long
def test_a_coupler_of_three_keeps_what_is_drawn():
    """Wheels that turn over several times, one of which is drawn turned by 20 degrees."""
    wheels = "".join(
        f"MARKER/1{k}, PART=1, QP={k},0,0\nPART/{k}, MASS=1, CM={k}0, IP=0.1,0.1,0.1, QG={k},0,0{turned}\n"
        f"MARKER/{k}0, PART={k}\nJOINT/{k}, REVOLUTE, I={k}0, J=1{k}\n"
        for k, turned in ((2, ""), (3, ", REULER=20D,0,0"), (4, ""))
    )
    solution = run(
        wheels
        + """COUPLER/1, JOINTS=2,3,4, TYPE=R:R:R, SCALES=1,-2,3
MOTION/1, JOINT=2, FUNCTION=20*TIME
SFORCE/1, I=30, J=13, ROTATIONAL, FUNCTION=5*SIN(3*TIME)
REQUEST/9, F2=AZ(20,12)-2*(AZ(30,13)-20D)+3*AZ(40,14)\\ F3=AZ(30,13)
"""
    )
    np.testing.assert_allclose(solution["REQUEST_9.f2"], 0, atol=1e-10)
    assert np.abs(solution["REQUEST_9.f3"]).max() > 2 * np.pi


@pytest.mark.long
def test_a_rack_pulls_a_pinion():
    """The rack's line is 0.2 m below the pinion's axis: turned forwards the pinion carries it along +x."""
    text = (
        TWO
        + """JOINT/1, REVOLUTE, I=21, J=1
MARKER/32, PART=3, QP=-1,-0.2,0, REULER=90D,90D,0
MARKER/15, PART=1, QP=0,-0.2,0, REULER=90D,90D,0
JOINT/2, TRANSLATIONAL, I=32, J=15
JOINT/3, RACKPIN, I=21, J=32, PD=0.4
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=32, J=15, FUNCTION=5
"""
    )
    solution = run(text)
    gained = 5 / (3 + 0.2 / 0.2**2) * solution.t
    np.testing.assert_allclose(solution["PART_3.vx"], gained, atol=1e-6)
    np.testing.assert_allclose(solution["PART_2.wz"], gained / 0.2, atol=1e-5)


@pytest.mark.long
def test_a_nut_falls_along_its_spindle():
    text = TWO + "JOINT/1, CYLINDRICAL, I=21, J=1\nJOINT/2, SCREW, I=21, J=1, PITCH=0.3\n" + GRAVITY
    solution = run(text)
    lead = 0.3 / (2 * math.pi)
    fall = -G * 2 / (2 + 0.2 / lead**2)
    np.testing.assert_allclose(solution["PART_2.vz"], fall * solution.t, atol=1e-6)
    np.testing.assert_allclose(solution["PART_2.wz"], fall * solution.t / lead, atol=1e-5)


BENT = math.radians(30)
SHAFTS = f"""PART/2, MASS=1, CM=20, IP=0.1,0.1,0.1
MARKER/20, PART=2
MARKER/21, PART=2
MARKER/22, PART=2, REULER=0,180D,0
PART/3, MASS=1, CM=30, IP=0.1,0.1,0.1, REULER=0,{BENT!r},0
MARKER/30, PART=3
MARKER/11, PART=1, REULER=0,{BENT!r},0
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, REVOLUTE, I=30, J=11
MOTION/1, JOINT=1, FUNCTION=4*TIME
VARIABLE/1, FUNCTION=AZ(30,11)
"""


def test_a_hooke_joint_turns_unevenly():
    """The arms are x of I (across the bend) and y of J: tan out = cos(bend) tan in."""
    solution = run(SHAFTS + "JOINT/3, HOOKE, I=21, J=30", 2.0)
    angle = 4 * solution.t
    out = solution["VARIABLE_1"]
    np.testing.assert_allclose(np.sin(out) * np.cos(angle), np.cos(out) * np.sin(angle) * math.cos(BENT), atol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("marker", [21, 22])
def test_a_constant_velocity_joint_turns_evenly(marker):
    solution = run(SHAFTS + f"JOINT/3, CONVEL, I={marker}, J=30", 2.0)
    np.testing.assert_allclose(solution["VARIABLE_1"], 4 * solution.t, atol=1e-6)


@pytest.mark.long
def test_a_ball_rolls_by_its_own_constraint():
    """A disc on edge that rolls along x: x' = -r w about y, held upright."""
    text = (
        GRAVITY
        + """PART/4, MASS=2, CM=40, IP=0.1,0.2,0.1, QG=0,0,0.5, VX=3, WY=6
MARKER/40, PART=4
MARKER/12, PART=1, QP=0,0,0.5, REULER=90D,90D,0
JPRIM/1, ORIENTATION, I=12, J=41
MARKER/41, PART=1, REULER=90D,90D,0
GCON/1, I=40, FUNCTION=VX(40) - 0.5*WY(40)
GCON/2, FUNCTION=DZ(40) - 0.5
GCON/3, FUNCTION=DY(40)
GFORCE/1, I=40, JFLOAT=19, RM=1, FX=1.4
MARKER/19, PART=1, FLOATING
"""
    )
    text = text.replace("JPRIM/1, ORIENTATION, I=12, J=41\n", "").replace(
        "QG=0,0,0.5, VX=3, WY=6", "QG=0,0,0.5, VX=3, WY=6"
    )
    solution = run(text)
    gained = 1.4 / (2 + 0.2 / 0.25) * solution.t
    np.testing.assert_allclose(solution["PART_4.vx"], 3 + gained, atol=1e-6)
    np.testing.assert_allclose(solution["PART_4.wy"], (3 + gained) / 0.5, atol=1e-6)


def test_the_joint_holds_before_assembly_moves_parts():
    """A part drawn a millimetre off is moved by the least amount, and the run says so."""
    text = TWO.replace("MARKER/21, PART=2", "MARKER/21, PART=2, QP=0.001,0,0") + "JOINT/1, SPHERICAL, I=21, J=1\n"
    solution = run(text + GRAVITY, 0.1)
    assert any("assembly changed PART_2.x by -0.001 m" in note for note in solution.notes)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("function", ["DM(20,11)-2-0.1*SIN(5*TIME)", "DM(20,11)-2.0+0*TIME", "DM(20,11)**2-4"])
def test_a_general_constraint_acts_on_its_marker(function):
    """A stone on a rope whose length is a function: the pull on marker I, on ground, is along the rope."""
    text = (
        GRAVITY
        + rf"""PART/2, MASS=1.5, CM=20, IP=1,1,1, QG=2,0,0
MARKER/20, PART=2
MARKER/11, PART=1
GCON/1, I=11, FUNCTION={function}
GCON/2, FUNCTION=DY(20)
REQUEST/1, F, I=11, J=20
REQUEST/2, F2=GCON(1,0,2,0)\F3=DX(20,11)/DM(20,11)\F4=DZ(20,11)/DM(20,11)
"""
    )
    solution = run(text)
    length = 2 + 0.1 * np.sin(5 * solution.t) if "SIN" in function else 2 + 0 * solution.t
    np.testing.assert_allclose(np.hypot(solution["PART_2.x"], solution["PART_2.z"]), length, atol=1e-8)
    tension = -1.5 * (
        solution["PART_2.ax"] * solution["REQUEST_2.f3"] + (solution["PART_2.az"] + G) * solution["REQUEST_2.f4"]
    )
    np.testing.assert_allclose(solution["REQUEST_1.fx"], tension * solution["REQUEST_2.f3"], atol=1e-6)
    np.testing.assert_allclose(solution["REQUEST_1.fz"], tension * solution["REQUEST_2.f4"], atol=1e-6)
    np.testing.assert_allclose(solution["REQUEST_1.tm"], 0, atol=1e-9)
    np.testing.assert_array_equal(solution["REQUEST_2.f2"], solution["REQUEST_1.fx"])


def test_velocities_that_are_left_open_follow_those_that_are_stated():
    """A crank with WZ stated, its rod without: the crank starts with just that, the rod as the loop demands."""
    text = """PART/2, MASS=2, CM=20, IP=0.1,0.1,0.2, WZ=6
MARKER/20, PART=2, QP=0.5,0,0
MARKER/21, PART=2
MARKER/22, PART=2, QP=1,0,0
PART/3, MASS=8, CM=30, IP=0.1,1,1, QG=1,0,0, REULER=90D,0,0
MARKER/30, PART=3, QP=1,0,0
MARKER/31, PART=3
MARKER/32, PART=3, QP=2,0,0
MARKER/12, PART=1, QP=1,2,0, REULER=0,90D,0
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, SPHERICAL, I=22, J=31
JPRIM/3, INLINE, I=32, J=12
JPRIM/4, INPLANE, I=30, J=1
"""
    solution = run(text, 0.01)
    start = {name: values[0] for name, values in solution.channels.items()}
    assert start["PART_2.wz"] == pytest.approx(6, abs=1e-9) and start["PART_2.vy"] == pytest.approx(3, abs=1e-9)
    # the rod's lower end moves up with 6 m/s, its upper end stays on x = 1: it moves up as a whole
    assert start["PART_3.vy"] == pytest.approx(6, abs=1e-9) and start["PART_3.wz"] == pytest.approx(0, abs=1e-9)
    assert not any("assembly changed" in note and "omega" in note for note in solution.notes)
