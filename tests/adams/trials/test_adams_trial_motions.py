"""Motions, couplers and gears of Adams datasets against index-1 equations that share no code."""

import numpy as np
import pytest

from . import adams_joints as joints
from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import moves_alike, near, played, table

pytestmark = [pytest.mark.long, pytest.mark.sampled(2)]

WEIGHT = "ACCGRAV/KGRAV=-9.80665\n"
TIMES = np.linspace(0, 1, 51)
TILTED = euler(0, 50, 20)

ARM = (
    WEIGHT
    + """MARKER/1, PART=1, REULER=0,50D,20D
PART/2, MASS=1.5, CM=20, IP=0.05,0.04,0.02{speeds}
MARKER/20, PART=2, QP=0.3,0.1,-0.1
MARKER/21, PART=2, REULER=0,50D,20D
"""
)
OWN, BASE = Marker(0, turn=TILTED), Marker(-1, turn=TILTED)


def arm(speed=0.0, rate=0.0):
    """The part of ARM, moving along its joint's z and turning about it."""
    z, center = TILTED[:, 2], np.array([0.3, 0.1, -0.1])
    return Part(1.5, tensor(0.05, 0.04, 0.02), center, np.eye(3), speed * z + np.cross(rate * z, center), rate * z)


def compare(folder, text, mechanism, reactions, bodies=("PART_2",), tolerance=2e-7):
    solution, history = played(folder, text), mechanism.run(TIMES)
    for k, body in enumerate(bodies):
        moves_alike(solution, body, history.part(k), tolerance)
    for name, marker in reactions.items():
        wanted = history.reaction(name, marker)
        near(table(solution, name), wanted, 100 * tolerance)
    return solution, history


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "motion, rate",
    [
        ("FUNCTION=0.2*SIN(4*TIME)", 0.8),
        ("ROTATION, DISPLACEMENT, FUNCTION=0.2*SIN(4*TIME)", 0.8),
        ("VELOCITY, FUNCTION=0.8*COS(4*TIME)", 0.8),
        ("VEL, ICDISP=0, FUNC=0.8*COS(4*TIME)", 0.8),
        ("ACCELERATION, ICDISP=0, ICVEL=0.8, FUNCTION=-3.2*SIN(4*TIME)", 0.8),
        ("ACCEL, ICVEL=45.836623610465864D, FUNCTION=-3.2*SIN(4*TIME)", 0.8),
    ],
)
def test_a_motor_by_its_angle_speed_or_acceleration(tmp_path, motion, rate):
    """Angle 0.2 sin 4t whichever way it is said; the part itself is said to be at rest."""
    second = joints.driven(joints.twist, OWN, BASE, lambda t: -3.2 * np.sin(4 * t))
    mechanism = Mechanism([arm(rate=rate)], {"JOINT_1": joints.revolute(OWN, BASE), "MOTION_1": second})
    text = ARM.format(speeds="") + f"JOINT/1, REVOLUTE, I=21, J=1\nMOTION/1, JOINT=1, {motion}"
    compare(tmp_path, text, mechanism, {"JOINT_1": OWN, "MOTION_1": OWN})


def test_a_sleeve_driven_both_ways(tmp_path):
    """TRANSLATION by its acceleration and ROTATION by degrees a second, on one cylindrical joint."""
    mechanism = Mechanism(
        [arm(speed=0.4, rate=np.pi / 3)],
        {
            "JOINT_1": joints.cylindrical(OWN, BASE),
            "MOTION_1": joints.driven(joints.slide, OWN, BASE, lambda t: 1 - 6 * t),
            "MOTION_2": joints.driven(joints.twist, OWN, BASE, lambda t: 0.0),
        },
    )
    text = ARM.format(speeds="") + (
        "JOINT/1, CYLINDRICAL, I=21, J=1\nMOTION/1, JOINT=1, TRANSLATION, ACCELERATION, ICVEL=0.4, FUNCTION=1-6*TIME\n"
        "MOTION/2, JOINT=1, ROTATION, VELOCITY, FUNCTION=60D"
    )
    compare(tmp_path, text, mechanism, {"JOINT_1": OWN, "MOTION_1": OWN, "MOTION_2": OWN})


def test_a_point_led_along_the_axes_of_a_moving_marker(tmp_path):
    """Y of I in the axes of J, which is on a swinging part: the motor pushes at I and pushes back there."""
    text = (
        ARM.format(speeds="")
        + """MARKER/22, PART=2, QP=0.4,0,0, REULER=30D,40D,0
JOINT/1, REVOLUTE, I=21, J=1
PART/3, MASS=0.8, CM=30, IP=0.02,0.03,0.01, QG=0.5,0.2,0
MARKER/30, PART=3
MARKER/31, PART=3, QP=-0.1,-0.05,0.1
MOTION/1, I=31, J=22, Y, FUNCTION={start}+0.05*(1-COS(5*TIME))"""
    )
    turn = euler(30, 40, 0)
    own, seat = Marker(1, (0.4, 0.15, 0.1)), Marker(0, (0.4, 0, 0), turn)

    def led(view):
        gap = (view.point(own) - view.point(seat)) @ view.axis(seat, "y")
        return gap.second[None] - 1.25 * np.cos(5 * view.t)

    mechanism = Mechanism(
        [arm(), Part(0.8, tensor(0.02, 0.03, 0.01), (0.5, 0.2, 0))],
        {"JOINT_1": joints.revolute(OWN, BASE), "MOTION_1": led},
    )
    start = np.array([0, 0.15, 0.1]) @ turn[:, 1]
    text = text.replace("{start}", repr(float(start)))
    compare(tmp_path, text, mechanism, {"JOINT_1": OWN, "MOTION_1": own}, ("PART_2", "PART_3"))


def test_a_motor_between_markers_whose_first_is_the_ground(tmp_path):
    """DZ of the ground's marker as the part sees it: the part goes the other way, the reaction is on the ground."""
    text = (
        ARM.format(speeds="")
        + "JOINT/1, TRANSLATIONAL, I=21, J=1\nMOTION/1, I=1, J=21, Z, FUNCTION=-0.1*(1-COS(5*TIME))\n"
        + r"REQUEST/1, F1=MOTION(1,1,6,0)\F2=MOTION(1,1,7,0)\F3=MOTION(1,1,8,0)"
    )
    mechanism = Mechanism(
        [arm()],
        {
            "JOINT_1": joints.translational(OWN, BASE),
            "MOTION_1": joints.driven(joints.slide, OWN, BASE, lambda t: 2.5 * np.cos(5 * t)),
        },
    )
    solution, history = compare(tmp_path, text, mechanism, {"JOINT_1": OWN})
    pushed = history.reaction("MOTION_1", BASE)[:, :3]
    near(table(solution, "MOTION_1", "fx fy fz"), pushed, 2e-5)
    gap = history.ask(lambda view: view.point(BASE).value - view.point(OWN).value)
    torque = table(solution, "MOTION_1", "tx ty tz")
    near(table(solution, "REQUEST_1", "f1 f2 f3"), -torque - np.cross(gap, pushed), 2e-5, 1.0)
    assert np.abs(torque).max() < 1e-9  # its line of action passes both markers


def test_a_motor_by_the_first_of_three_angles(tmp_path):
    """B1 alone is a turn about x of J; the hinge is along it."""
    turn = TILTED @ euler(90, 90, 0)  # z of the hinge along x of the markers 1 and 21
    text = (
        ARM.format(speeds="")
        + "MARKER/2, PART=1, ZP={z}\nMARKER/23, PART=2, ZP={z}\n".format(
            z=", ".join(f"{number:.17g}" for number in turn[:, 2])
        )
        + "JOINT/1, REVOLUTE, I=23, J=2\nMOTION/1, I=21, J=1, B1, VELOCITY, FUNCTION=0.9*SIN(3*TIME)"
    )
    own, base = Marker(0, turn=turn), Marker(-1, turn=turn)
    mechanism = Mechanism(
        [arm()],
        {
            "JOINT_1": joints.revolute(own, base),
            "MOTION_1": joints.driven(joints.twist, own, base, lambda t: 2.7 * np.cos(3 * t)),
        },
    )
    compare(tmp_path, text, mechanism, {"JOINT_1": own, "MOTION_1": own})


GEARED = (
    WEIGHT
    + """MARKER/1, PART=1, REULER=0,90D,0
MARKER/2, PART=1, QP=1,0,0, REULER=0,90D,0
MARKER/3, PART=1, QP=2,0,0, REULER=45D,60D,0
PART/2, MASS=1, CM=20, IP=0.02,0.03,0.04
MARKER/20, PART=2, QP=0.1,0,0.05
MARKER/21, PART=2, REULER=0,90D,0
PART/3, MASS=2, CM=30, IP=0.2,0.1,0.3, QG=1,0,0
MARKER/30, PART=3, QP=0,0.1,-0.1
MARKER/31, PART=3, REULER=0,90D,0
PART/4, MASS=0.5, CM=40, IP=0.02,0.01,0.03, QG=2,0,0
MARKER/40, PART=4, QP=0.1,0.1,-0.1
MARKER/41, PART=4, REULER=45D,60D,0
"""
)
SLANT = euler(45, 60, 0)
WHEELS = [
    Part(1, tensor(0.02, 0.03, 0.04), (0.1, 0, 0.05)),
    Part(2, tensor(0.2, 0.1, 0.3), (1, 0.1, -0.1)),
    Part(0.5, tensor(0.02, 0.01, 0.03), (2.1, 0.1, -0.1)),
]
AXES = [
    (Marker(k, (k, 0, 0), turn), Marker(-1, (k, 0, 0), turn)) for k, turn in enumerate([euler(0, 90, 0)] * 2 + [SLANT])
]
BODIES = ("PART_2", "PART_3", "PART_4")


def test_a_coupler_of_three_joints_of_three_kinds(tmp_path):
    """2 q1 - 3 q2 + 0.5 q3 = 0 of a hinge, of the slide of a sleeve that also turns freely, and of a guide."""
    text = GEARED + (
        "JOINT/1, REVOLUTE, I=21, J=1\nJOINT/2, CYLINDRICAL, I=31, J=2\nJOINT/3, TRANSLATIONAL, I=41, J=3\n"
        "COUPLER/1, JOINTS=1,2,3, TYPE=R:T:T, SCALES=2,-3,0.5\nREQUEST/1, F2=COUPLER(1,1,7,0)"
    )
    relation = joints.coupled((2, joints.twist, *AXES[0]), (-3, joints.slide, *AXES[1]), (0.5, joints.slide, *AXES[2]))
    mechanism = Mechanism(
        WHEELS,
        {
            "JOINT_1": joints.revolute(*AXES[0]),
            "JOINT_2": joints.cylindrical(*AXES[1]),
            "JOINT_3": joints.translational(*AXES[2]),
            "COUPLER_1": relation,
        },
    )
    reactions = {f"JOINT_{k + 1}": AXES[k][0] for k in range(3)} | {"COUPLER_1": AXES[0][0]}
    solution, history = compare(tmp_path, text, mechanism, reactions, BODIES)
    near(solution.channels["REQUEST_1.f2"], -history.reaction("COUPLER_1", AXES[0][0])[:, 4], 2e-5)


def test_a_coupler_of_two_joints_with_one_scale_and_a_ground_marker_first(tmp_path):
    """SCALES of one number are those of the second joint; q is of I against J also when I is the ground's."""
    text = GEARED + (
        "JOINT/1, REVOLUTE, I=1, J=21\nJOINT/2, REVOLUTE, I=31, J=2\nJOINT/3, FIXED, I=41, J=3\n"
        "COUPLER/1, JOINTS=1,2, SCALES=-2.5"
    )
    relation = joints.coupled((1, joints.twist, *AXES[0][::-1]), (-2.5, joints.twist, *AXES[1]))
    mechanism = Mechanism(
        WHEELS,
        {
            "JOINT_1": joints.revolute(*AXES[0]),
            "JOINT_2": joints.revolute(*AXES[1]),
            "JOINT_3": joints.fixed(*AXES[2]),
            "COUPLER_1": relation,
        },
    )
    reactions = {"JOINT_1": AXES[0][1], "JOINT_2": AXES[1][0], "COUPLER_1": AXES[0][1]}
    compare(tmp_path, text, mechanism, reactions, BODIES)


@pytest.mark.parametrize("contact", [(0.3, 0, 0), (-0.5, 0, 0)], ids=["outside", "inside"])
def test_spur_gears_outside_and_inside(tmp_path, contact):
    """CV's z is along the teeth's motion, -z of ground here; radii 0.3 and 0.7, or 0.5 and 1.5 within a ring."""
    text = GEARED + (
        f"MARKER/5, PART=1, QP={contact[0]},0,0, REULER=0,180D,0\n"
        "JOINT/1, REVOLUTE, I=21, J=1\nJOINT/2, REVOLUTE, I=31, J=2\nJOINT/3, FIXED, I=41, J=3\n"
        "GEAR/1, JOINTS=1,2, CV=5\n"
        r"REQUEST/1, F2=GEAR(1,1,2,0)\F3=GEAR(1,1,3,0)\F4=GEAR(1,1,4,0)\F6=GEAR(1,1,6,0)\F7=GEAR(1,1,7,0)\F8=GEAR(1,1,8,0)"
    )
    mechanism = Mechanism(
        WHEELS,
        {
            "JOINT_1": joints.revolute(*AXES[0]),
            "JOINT_2": joints.revolute(*AXES[1]),
            "JOINT_3": joints.fixed(*AXES[2]),
            "GEAR_1": joints.meshed(AXES[0][0], AXES[1][0], Marker(-1, contact, euler(0, 180, 0))),
        },
    )
    reactions = {"JOINT_1": AXES[0][0], "JOINT_2": AXES[1][0], "GEAR_1": AXES[0][0]}
    solution, history = compare(tmp_path, text, mechanism, reactions, BODIES, 1e-6)
    near(table(solution, "REQUEST_1", "f2 f3 f4 f6 f7 f8"), history.reaction("GEAR_1", AXES[1][0]), 1e-4)


def test_bevel_gears_at_an_angle_of_sixty_degrees(tmp_path):
    """Axes in the x-y plane that meet at the origin, teeth moving along z where they touch, bearings that feel them."""
    text = (
        WEIGHT
        + """MARKER/1, PART=1, REULER=0,90D,0
MARKER/2, PART=1, REULER=60D,90D,0
MARKER/5, PART=1, QP=0.4,-0.6,0
PART/2, MASS=1, CM=20, IP=0.02,0.03,0.04
MARKER/20, PART=2, QP=0.1,-0.4,0.05
MARKER/21, PART=2, REULER=0,90D,0
PART/3, MASS=2, CM=30, IP=0.2,0.1,0.3
MARKER/30, PART=3, QP=0.8,-0.3,-0.1
MARKER/31, PART=3, REULER=60D,90D,0
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, REVOLUTE, I=31, J=2
GEAR/1, JOINTS=1,2, CV=5"""
    )
    pairs = [
        (Marker(0, turn=euler(0, 90, 0)), Marker(-1, turn=euler(0, 90, 0))),
        (Marker(1, turn=euler(60, 90, 0)), Marker(-1, turn=euler(60, 90, 0))),
    ]

    teeth = joints.meshed(pairs[0][0], pairs[1][0], Marker(-1, (0.4, -0.6, 0)))
    mechanism = Mechanism(
        [Part(1, tensor(0.02, 0.03, 0.04), (0.1, -0.4, 0.05)), Part(2, tensor(0.2, 0.1, 0.3), (0.8, -0.3, -0.1))],
        {"JOINT_1": joints.revolute(*pairs[0]), "JOINT_2": joints.revolute(*pairs[1]), "GEAR_1": teeth},
    )
    reactions = {"JOINT_1": pairs[0][0], "JOINT_2": pairs[1][0], "GEAR_1": pairs[0][0]}
    compare(tmp_path, text, mechanism, reactions, ("PART_2", "PART_3"))


def test_planetary_gears_on_a_turning_carrier(tmp_path):
    """CV on the carrier: the sun (first joint's J on ... I on the sun) and the planet turn against the carrier."""
    text = (
        WEIGHT
        + """MARKER/1, PART=1, REULER=0,90D,0
PART/2, MASS=1, CM=20, IP=0.02,0.03,0.04
MARKER/20, PART=2, QP=0.4,0,0.1
MARKER/21, PART=2, REULER=0,90D,0
MARKER/22, PART=2, QP=0.5,0,0, REULER=0,90D,0
MARKER/23, PART=2, QP=0.2,0,0
PART/3, MASS=2, CM=30, IP=0.2,0.1,0.3
MARKER/30, PART=3, QP=0.05,0,0.1
MARKER/31, PART=3, REULER=0,90D,0
PART/4, MASS=0.5, CM=40, IP=0.02,0.01,0.03, QG=0.5,0,0
MARKER/40, PART=4, QP=0.02,0,0.03
MARKER/41, PART=4, REULER=0,90D,0
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, REVOLUTE, I=31, J=21
JOINT/3, REVOLUTE, I=22, J=41
GEAR/1, JOINTS=2,3, CV=23"""
    )
    y = euler(0, 90, 0)
    carrier, sun, planet = Marker(0, turn=y), Marker(1, turn=y), Marker(2, (0.5, 0, 0), y)
    seat = Marker(0, (0.5, 0, 0), y)
    relation = joints.meshed(sun, planet, Marker(0, (0.2, 0, 0)))
    mechanism = Mechanism(
        [
            Part(1, tensor(0.02, 0.03, 0.04), (0.4, 0, 0.1)),
            Part(2, tensor(0.2, 0.1, 0.3), (0.05, 0, 0.1)),
            Part(0.5, tensor(0.02, 0.01, 0.03), (0.52, 0, 0.03)),
        ],
        {
            "JOINT_1": joints.revolute(carrier, Marker(-1, turn=y)),
            "JOINT_2": joints.revolute(sun, carrier),
            "JOINT_3": joints.revolute(planet, seat),
            "GEAR_1": relation,
        },
    )
    reactions = {"JOINT_1": carrier, "JOINT_2": sun, "JOINT_3": seat, "GEAR_1": sun}
    compare(tmp_path, text, mechanism, reactions, BODIES)


@pytest.mark.long
def test_a_rack_by_a_gear_and_a_helical_wheel_on_a_sleeve(tmp_path):
    """A wheel between a guide and a sleeve, crooked teeth: CV leans out of the wheels' planes."""
    text = (
        GEARED
        + "MARKER/5, PART=1, QP=0.4,0.1,0.2, REULER=70D,30D,0\nMARKER/6, PART=1, QP=1.6,0.05,0.3, REULER=20D,70D,0\n"
        + "JOINT/1, CYLINDRICAL, I=1, J=21\nJOINT/2, REVOLUTE, I=31, J=2\nJOINT/3, TRANSLATIONAL, I=41, J=3\n"
        + "GEAR/1, JOINTS=1,2, CV=5\nGEAR/2, JOINTS=3,2, CV=6"
    )
    contacts = Marker(-1, (0.4, 0.1, 0.2), euler(70, 30, 0)), Marker(-1, (1.6, 0.05, 0.3), euler(20, 70, 0))
    mechanism = Mechanism(
        WHEELS,
        {
            "JOINT_1": joints.cylindrical(*AXES[0][::-1]),
            "JOINT_2": joints.revolute(*AXES[1]),
            "JOINT_3": joints.translational(*AXES[2]),
            "GEAR_1": joints.meshed(AXES[0][0], AXES[1][0], contacts[0]),
            "GEAR_2": joints.meshed(AXES[2][0], AXES[1][0], contacts[1]),
        },
    )
    reactions = {"JOINT_1": AXES[0][1], "JOINT_2": AXES[1][0], "JOINT_3": AXES[2][0], "GEAR_1": AXES[0][0]}
    compare(tmp_path, text, mechanism, reactions | {"GEAR_2": AXES[2][0]}, BODIES)


@pytest.mark.parametrize(
    "law",
    ["IF(TIME-0.5: TIME**2, 0.25, TIME-0.25)", "IF(0.5-TIME: TIME-0.25, 0.25, TIME**2)"],
    ids=["rising", "falling"],
)
def test_the_middle_value_of_if_is_no_stop_of_a_motion(tmp_path, law):
    """It holds for an instant, whose row has the side before it; the velocity does not jump there."""
    text = (
        "MARKER/1, PART=1\nPART/2, MASS=1, CM=20, IP=0.1,0.1,0.2\nMARKER/20, PART=2\nJOINT/1, REVOLUTE, I=20, J=1\n"
        f"MOTION/1, JOINT=1, FUNCTION={law}"
    )
    solution = played(tmp_path, text)
    t = solution.time
    assert t[-1] == 1 and 0.5 in t
    np.testing.assert_allclose(solution["PART_2.wz"], np.minimum(2 * t, 1), atol=1e-7)
    np.testing.assert_allclose(solution["MOTION_1.tz"], np.where(t <= 0.5, 0.4, 0), atol=1e-6)
    assert not any("jump" in note for note in solution.notes)
