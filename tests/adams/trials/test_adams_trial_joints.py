"""Every kind of joint of an Adams dataset, with crooked markers, against index-1 equations that share no code."""

import numpy as np
import pytest

from . import adams_joints as joints
from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import moves_alike, near, played, table

pytestmark = [pytest.mark.long, pytest.mark.sampled(2)]

WEIGHT = "ACCGRAV/KGRAV=-9.80665\n"
TIMES = np.linspace(0, 1, 51)


def compare(folder, text, mechanism, reactions, bodies=("PART_2",), head=None, tolerance=2e-7):
    """Bodies and reactions (name -> marker I) of a dataset against a mechanism."""
    settings = {"head": head} if head else {}
    solution, history = played(folder, text, **settings), mechanism.run(TIMES)
    for k, body in enumerate(bodies):
        moves_alike(solution, body, history.part(k), tolerance)
    for name, marker in reactions.items():
        wanted = history.reaction(name, marker)
        near(table(solution, name, "fx fy fz"), wanted[:, :3], 100 * tolerance, np.abs(wanted).max())
        near(table(solution, name, "tx ty tz"), wanted[:, 3:], 100 * tolerance, np.abs(wanted).max())
    return solution, history


SKEW = euler(40, 70, -25)  # of the joint, in ground axes
BODY = euler(15, -50, 80)  # of the part
CENTER = euler(-35, 20, 10)  # of the centre-of-mass marker, in the part
PLACE, ORIGIN, HUB = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.4, -0.3]), np.array([0.25, 0.1, -0.15])


def crooked(statement, swapped=False, start=""):
    """A part with its own axes, a centre marker turned in it, and one joint to ground at PLACE.

    The part's marker of the joint is where the ground's is, in the part's axes, by numbers.
    """
    q = BODY.T @ (PLACE - ORIGIN)
    x, z = ([*(q + BODY.T @ SKEW[:, k] * 0.5)] for k in (0, 2))
    listed = [", ".join(f"{number:.16g}" for number in numbers) for numbers in (q, x, z)]
    pair = "I=1, J=21" if swapped else "I=21, J=1"
    return f"""MARKER/1, PART=1, QP=0.3,-0.2,0.5, REULER=40D,70D,-25D
PART/2, QG=0.1,0.4,-0.3, REULER=15D,-50D,80D
, MASS=2.5, CM=20, IP=0.11,0.09,0.14,0.02,-0.01,0.015 {start}
MARKER/20, PART=2, QP=0.25,0.1,-0.15, REULER=-35D,20D,10D
MARKER/21, PART=2, QP={listed[0]}
, ZP={listed[2]}
, XP={listed[1]}
{WEIGHT}JOINT/1, {statement}, {pair}"""


def crooked_part(speed=0.0, spin=0.0):
    """The same for the oracle, moving along the joint's z and turning about it."""
    center = ORIGIN + BODY @ HUB
    z = SKEW[:, 2]
    inertia = tensor(0.11, 0.09, 0.14, 0.02, -0.01, 0.015)
    velocity = speed * z + np.cross(spin * z, center - PLACE)
    return Part(2.5, inertia, center, BODY @ CENTER, velocity, spin * z)


GROUND, OWN = Marker(-1, PLACE, SKEW), Marker(0, PLACE, SKEW)


def starting(part):
    """VX .. in ground axes, WX .. about the axes of the centre-of-mass marker (Adams' default)."""
    rates = part.turn.T @ np.array(part.spin)
    numbers = [*zip(("VX", "VY", "VZ"), part.velocity, strict=True), *zip(("WX", "WY", "WZ"), rates, strict=True)]
    return "\n, " + ", ".join(f"{name}={number:.16g}" for name, number in numbers)


def test_a_crooked_hinge(tmp_path):
    part = crooked_part(spin=3.0)
    mechanism = Mechanism([part], {"JOINT_1": joints.revolute(OWN, GROUND)})
    compare(tmp_path, crooked("REVOLUTE", start=starting(part)), mechanism, {"JOINT_1": OWN})


def test_the_reaction_is_that_on_marker_i_when_i_is_the_ground(tmp_path):
    part = crooked_part(spin=3.0)
    mechanism = Mechanism([part], {"JOINT_1": joints.revolute(GROUND, OWN)})
    compare(tmp_path, crooked("REVOLUTE", True, starting(part)), mechanism, {"JOINT_1": GROUND})


def test_a_crooked_guide_either_way(tmp_path):
    part = crooked_part(speed=-1.5)
    for swapped, pair in ((False, (OWN, GROUND)), (True, (GROUND, OWN))):
        mechanism = Mechanism([part], {"JOINT_1": joints.translational(*pair)})
        compare(tmp_path, crooked("TRANSLATIONAL", swapped, starting(part)), mechanism, {"JOINT_1": pair[0]})


def test_a_crooked_sleeve_either_way(tmp_path):
    part = crooked_part(speed=0.8, spin=-2.0)
    for swapped, pair in ((False, (OWN, GROUND)), (True, (GROUND, OWN))):
        mechanism = Mechanism([part], {"JOINT_1": joints.cylindrical(*pair)})
        compare(tmp_path, crooked("CYLINDRICAL", swapped, starting(part)), mechanism, {"JOINT_1": pair[0]})


def test_a_crooked_ball_joint(tmp_path):
    part = crooked_part(spin=4.0)
    mechanism = Mechanism([part], {"JOINT_1": joints.atpoint(OWN, GROUND)})
    compare(tmp_path, crooked("SPHERICAL", start=starting(part)), mechanism, {"JOINT_1": OWN})


def test_a_crooked_hooke_joint_either_way(tmp_path):
    part = crooked_part()
    for swapped, pair in ((False, (OWN, GROUND)), (True, (GROUND, OWN))):
        mechanism = Mechanism([part], {"JOINT_1": joints.hooke(*pair)})
        compare(tmp_path, crooked("HOOKE", swapped), mechanism, {"JOINT_1": pair[0]})


def test_a_crooked_planar_joint_either_way(tmp_path):
    part = crooked_part(spin=2.0)
    for swapped, pair in ((False, (OWN, GROUND)), (True, (GROUND, OWN))):
        mechanism = Mechanism([part], {"JOINT_1": joints.planar(*pair)})
        compare(tmp_path, crooked("PLANAR", swapped, starting(part)), mechanism, {"JOINT_1": pair[0]})


def test_a_nut_on_a_screw_that_hangs_askew(tmp_path):
    """PITCH is what I moves along z of J in a turn, positive for a right-hand thread."""
    pitch = 0.3
    part = crooked_part(speed=pitch, spin=2 * np.pi)
    text = crooked("CYLINDRICAL", start=starting(part)) + "\nJOINT/2, SCREW, PITCH=0.3, I=21, J=1"
    screw = joints.coupled((1, joints.slide, OWN, GROUND), (-pitch / (2 * np.pi), joints.twist, OWN, GROUND))
    mechanism = Mechanism([part], {"JOINT_1": joints.cylindrical(OWN, GROUND), "JOINT_2": screw})
    compare(tmp_path, text, mechanism, {"JOINT_1": OWN, "JOINT_2": OWN})


def test_a_universal_joint_has_its_arms_along_z(tmp_path):
    """Two rods: the first hangs from a UNIVERSAL joint, the second from it by another, with other arms."""
    text = (
        WEIGHT
        + """MARKER/1, PART=1, REULER=0,0,0
PART/2, MASS=1, CM=20, IP=0.02,0.02,0.01
MARKER/20, PART=2, QP=0.2,0,0.1
MARKER/21, PART=2, REULER=0,90D,0
MARKER/22, PART=2, QP=0.5,0,0, REULER=30D,90D,0
PART/3, MASS=0.7, CM=30, IP=0.01,0.015,0.02, QG=0.5,0,0
MARKER/30, PART=3, QP=0.3,0.1,0
MARKER/31, PART=3, REULER=120D,90D,0
JOINT/1, UNIVERSAL, I=21, J=1
JOINT/2, UNIV, J=31, I=22"""
    )
    first, second = Marker(0, turn=euler(0, 90, 0)), Marker(0, (0.5, 0, 0), euler(30, 90, 0))
    third = Marker(1, (0.5, 0, 0), euler(120, 90, 0))
    mechanism = Mechanism(
        [Part(1, tensor(0.02, 0.02, 0.01), (0.2, 0, 0.1)), Part(0.7, tensor(0.01, 0.015, 0.02), (0.8, 0.1, 0))],
        {"JOINT_1": joints.universal(first, Marker(-1)), "JOINT_2": joints.universal(second, third)},
    )
    compare(tmp_path, text, mechanism, {"JOINT_1": first, "JOINT_2": second}, ("PART_2", "PART_3"))


def test_two_parts_fixed_together_swing_as_one(tmp_path):
    text = (
        WEIGHT
        + """MARKER/1, PART=1, REULER=0,90D,0
PART/2, MASS=1, CM=20, IP=0.02,0.02,0.01
MARKER/20, PART=2, QP=0.2,0,0.1
MARKER/21, PART=2, REULER=0,90D,0
MARKER/22, PART=2, QP=0.5,0,0, REULER=30D,60D,0
PART/3, MASS=0.7, CM=30, IP=0.01,0.015,0.02, QG=0.5,0,0
MARKER/30, PART=3, QP=0.3,0.1,0
MARKER/31, PART=3, REULER=30D,60D,0
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, FIXED, I=31, J=22"""
    )
    hinge, bolt = Marker(0, turn=euler(0, 90, 0)), Marker(1, (0.5, 0, 0), euler(30, 60, 0))
    mechanism = Mechanism(
        [Part(1, tensor(0.02, 0.02, 0.01), (0.2, 0, 0.1)), Part(0.7, tensor(0.01, 0.015, 0.02), (0.8, 0.1, 0))],
        {
            "JOINT_1": joints.revolute(hinge, Marker(-1, turn=euler(0, 90, 0))),
            "JOINT_2": joints.fixed(bolt, Marker(0, (0.5, 0, 0), euler(30, 60, 0))),
        },
    )
    compare(tmp_path, text, mechanism, {"JOINT_1": hinge, "JOINT_2": bolt}, ("PART_2", "PART_3"))


def test_a_constant_velocity_joint_between_a_motor_shaft_and_a_hanging_shaft(tmp_path):
    """z axes point away from the centre, x axes are parallel, bent by 30 degrees at the start."""
    text = (
        "ACCGRAV/JGRAV=9.80665\n"
        + """MARKER/1, PART=1, REULER=0,-90D,0
PART/2, MASS=1, CM=20, IP=0.02,0.01,0.02
MARKER/20, PART=2, QP=0,-0.2,0
MARKER/21, PART=2, REULER=0,-90D,0
MARKER/22, PART=2, REULER=0,90D,0
PART/3, MASS=0.7, CM=30, IP=0.01,0.015,0.02
MARKER/30, PART=3, QP=0.0,0.3,0.1
MARKER/31, PART=3, REULER=0,-60D,0
JOINT/1, REVOLUTE, I=21, J=1
MOTION/1, JOINT=1, FUNCTION=TIME**2*90D
JOINT/2, CONVEL, I=22, J=31"""
    )
    shaft, away, other = (Marker(k, turn=euler(0, a, 0)) for k, a in ((0, -90), (0, 90), (1, -60)))
    base = Marker(-1, turn=euler(0, -90, 0))
    mechanism = Mechanism(
        [Part(1, tensor(0.02, 0.01, 0.02), (0, -0.2, 0)), Part(0.7, tensor(0.01, 0.015, 0.02), (0, 0.3, 0.1))],
        {
            "JOINT_1": joints.revolute(shaft, base),
            "MOTION_1": joints.driven(joints.twist, shaft, base, lambda t: np.pi),
            "JOINT_2": joints.convel(away, other),
        },
        gravity=(0, 9.80665, 0),
    )
    reactions = {"JOINT_1": shaft, "JOINT_2": away, "MOTION_1": shaft}
    compare(tmp_path, text, mechanism, reactions, ("PART_2", "PART_3"))


RACK = """ACCGRAV/IGRAV=9.80665
MARKER/1, PART=1
MARKER/2, PART=1, QP=0.4,-0.15,0.1, REULER=90D,90D,-90D
PART/2, MASS=1, CM=20, IP=0.02,0.03,0.04
MARKER/20, PART=2, QP=0.05,0,0
MARKER/21, PART=2
PART/3, MASS=2, CM=30, IP=0.1,0.2,0.3
MARKER/30, PART=3, QP=0.1,-0.15,0
MARKER/31, PART=3, QP=0.4,-0.15,0.1, REULER=90D,90D,-90D
MARKER/32, PART=3, QP=0.0,{y},0, REULER=90D,90D,-90D
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, TRANSLATIONAL, I=31, J=2
JOINT/3, RACKPIN, I=21, J=32, PD=0.3
REQUEST/1, F2=JOINT(3,1,2,0)"""


def test_a_rack_falls_beside_its_pinion(tmp_path):
    """The rack is at -y of the pinion's marker, whose x is along its z: a turn forwards moves it forwards.

    The pinion feels the teeth's force where they touch; with a rack drawn through its centre, which says nothing of the
    side, it moves alike.
    """
    along = euler(90, 90, -90)
    pinion, base, contact = Marker(0), Marker(-1), np.array([0, -0.15, 0])
    guide, rail = Marker(1, (0.4, -0.15, 0.1), along), Marker(-1, (0.4, -0.15, 0.1), along)

    def teeth(view):
        touched = view.point(pinion).second + np.cross(view.spin(pinion).second, contact) - view.point(guide).second
        return touched[:, 0][None]

    mechanism = Mechanism(
        [Part(1, tensor(0.02, 0.03, 0.04), (0.05, 0, 0)), Part(2, tensor(0.1, 0.2, 0.3), (0.1, -0.15, 0))],
        {"JOINT_1": joints.revolute(pinion, base), "JOINT_2": joints.translational(guide, rail), "JOINT_3": teeth},
        gravity=(9.80665, 0, 0),
    )
    reactions = {"JOINT_1": pinion, "JOINT_3": pinion}
    solution, _ = compare(tmp_path, RACK.format(y=-0.15), mechanism, reactions, ("PART_2", "PART_3"))
    near(solution.channels["REQUEST_1.f2"], -solution.channels["JOINT_3.fx"], 1e-9)
    solution, history = compare(tmp_path, RACK.format(y=0), mechanism, {}, ("PART_2", "PART_3"))
    near(table(solution, "JOINT_3", "tx ty tz"), history.reaction("JOINT_3", pinion)[:, 3:], 2e-5)


def test_six_parts_by_a_primitive_each(tmp_path):
    """ATPOINT, INLINE, INPLANE, ORIENTATION, PARALLEL_AXES and PERPENDICULAR, each between two crooked markers."""
    kinds = {
        "ATPOINT": joints.atpoint,
        "INLINE": joints.inline,
        "INPLANE": joints.inplane,
        "ORIENTATION": joints.orientation,
        "PARALLEL_AXES": joints.parallel,
        "PERPENDICULAR": joints.perpendicular,
    }
    lines, parts, equations, reactions = [WEIGHT, "MARKER/1, PART=1, REULER=20D,40D,60D"], [], {}, {}
    base = Marker(-1, turn=euler(20, 40, 60))
    for k, (kind, joint) in enumerate(kinds.items()):
        n = k + 2
        angles = (20, 130, 60) if kind == "PERPENDICULAR" else (20, 40, 60)
        lines.append(
            f"PART/{n}, MASS=2, CM={n}0, IP=0.3,0.2,0.4\nMARKER/{n}0, PART={n}, QP=0.3,-0.2,0.1\n"
            f"MARKER/{n}1, PART={n}, REULER={angles[0]}D,{angles[1]}D,{angles[2]}D\nJPRIM/{n}, {kind}, I={n}1, J=1"
        )
        own = Marker(k, turn=euler(*angles))
        parts.append(Part(2, tensor(0.3, 0.2, 0.4), (0.3, -0.2, 0.1)))
        equations[f"JPRIM_{n}"], reactions[f"JPRIM_{n}"] = joint(own, base), own
    names = tuple(f"PART_{k}" for k in range(2, 8))
    compare(tmp_path, "\n".join(lines), Mechanism(parts, equations), reactions, names)
