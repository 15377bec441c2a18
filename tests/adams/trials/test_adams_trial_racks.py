"""A pinion and a rack of an Adams dataset on a turning carrier, crooked in space, against equations that share no code."""

import numpy as np
import pytest

import stiffmbs

from . import adams_joints as joints
from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import HEAD, moves_alike, near, played, table

TIMES = np.linspace(0, 1, 51)
RADIUS, SPIN, TURN = 0.15, 5.0, 1.2  # of the pinion, its rate against the carrier, the carrier's rate
HUB = np.array([0.3, -0.2, 0.25])
ALL = euler(35, 70, -110)  # z along the pinion's axis, x along the rack, which is at -y
ALONG = ALL @ np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # z along the rack
POST, AXIS = np.array([-0.1, 0.2, 0.05]), euler(-60, 40, 20)
MASSES = (4, 1, 2)
TENSORS = (tensor(0.3, 0.2, 0.4, 0.02, 0.01, -0.03), tensor(0.02, 0.03, 0.04, 0.001, 0, 0.002), tensor(0.1, 0.05, 0.08))


def at(*place):
    """Ground coordinates of a point that is given from the pinion's centre in ALL's axes."""
    return HUB + ALL @ place


CENTERS = ((0.1, 0.2, -0.3), at(0.05, 0.03, -0.02), at(0.1, -0.25, 0.04))


def numbers(values):
    return ", ".join(f"{value:.17g}" for value in np.atleast_1d(values))


def placed(ident, marker):
    """MARKER statement by points on its axes."""
    z, x = (marker.place + marker.turn[:, k] for k in (2, 0))
    return f"MARKER/{ident}, PART={marker.part + 2}, QP={numbers(marker.place)}, ZP={numbers(z)}, XP={numbers(x)}"


def starts():
    """Velocity and spin of carrier, pinion and rack."""
    turning = TURN * AXIS[:, 2]
    spins = (turning, turning + SPIN * ALL[:, 2], turning)
    hub = np.cross(turning, HUB - POST)
    carrier = np.cross(turning, CENTERS[0] - POST)
    pinion = hub + np.cross(spins[1], CENTERS[1] - HUB)
    rack = np.cross(turning, CENTERS[2] - POST) + SPIN * RADIUS * ALL[:, 0]
    return list(zip((carrier, pinion, rack), spins, strict=True))


def teeth(pinion, contact):
    """The pinion at the pitch line and the rack have one velocity along the rack."""

    def equation(view):
        gap, along, spin = view.point(contact) - view.point(pinion), view.axis(contact, "z"), view.spin(pinion)
        sliding = gap.rate - np.cross(spin.rate, gap.value)
        changing = gap.second - np.cross(spin.second, gap.value) - np.cross(spin.rate, gap.rate)
        return (changing @ along.value + sliding @ along.rate)[None]

    return equation


@pytest.mark.long
@pytest.mark.parametrize(
    "drawn, backward, swapped",
    [(RADIUS, False, False), (RADIUS, True, True), (0.0, False, False), (0.0, True, False), (0.1, False, True)],
    ids=["in place", "in place, z backward", "across the axis", "across the axis, z backward", "too near"],
)
@pytest.mark.sampled(7)
def test_a_rack_on_a_turning_carrier(tmp_path, drawn, backward, swapped):
    """All parts and the reactions of all joints, those of the teeth on the pinion and on the rack.

    The rack's marker is off the pinion's middle plane; where it is drawn across the axis x of I tells the side.
    """
    aside = euler(0, 0, 0 if drawn == 0 else 50)  # what x of the pinion's marker is is all the same otherwise
    pinion, bearing = Marker(1, HUB, ALL @ aside), Marker(0, HUB, ALL)
    shoe, rail = (Marker(k, at(0.3, -0.2, 0.1), ALONG) for k in (2, 0))
    facing = ALONG @ euler(0, 180, 0) if backward else ALONG
    rack, contact = (Marker(2, at(0.05, -y, 0.07), facing @ euler(0, 0, 25)) for y in (drawn, RADIUS))
    lines = ["ACCGRAV/IGRAV=3, JGRAV=-5, KGRAV=-7"]
    for k, (velocity, spin) in enumerate(starts()):
        rates = zip(("VX", "VY", "VZ", "WX", "WY", "WZ"), [*velocity, *spin], strict=True)
        i = TENSORS[k]
        moments = numbers([i[0, 0], i[1, 1], i[2, 2], -i[0, 1], -i[0, 2], -i[1, 2]])
        lines += [
            f"PART/{k + 2}, MASS={MASSES[k]}, CM={k + 2}0, IP={moments}, "
            + ", ".join(f"{name}={value:.17g}" for name, value in rates),
            placed(10 * (k + 2), Marker(k, np.array(CENTERS[k]))),
        ]
    every = {
        1: Marker(-1, POST, AXIS),
        21: Marker(0, POST, AXIS),
        22: bearing,
        23: rail,
        31: pinion,
        41: shoe,
        42: rack,
    }
    lines += [placed(ident, marker) for ident, marker in every.items()]
    hinge = (22, 31) if swapped else (31, 22)
    guide = (23, 41) if swapped else (41, 23)
    lines += [
        "JOINT/1, REVOLUTE, I=21, J=1",
        f"JOINT/2, REVOLUTE, I={hinge[0]}, J={hinge[1]}",
        f"JOINT/3, TRANSLATIONAL, I={guide[0]}, J={guide[1]}",
        f"JOINT/4, RACKPIN, I=31, J=42, PD={2 * RADIUS}",
        r"REQUEST/1, F2=JOINT(4,1,2,0)\F3=JOINT(4,1,3,0)\F4=JOINT(4,1,4,0)\F6=JOINT(4,1,6,0)\F7=JOINT(4,1,7,0)\F8=JOINT(4,1,8,0)",
        "REQUEST/2, FORCE, I=42, J=31, RM=41",
    ]
    parts = [
        Part(MASSES[k], TENSORS[k], CENTERS[k], np.eye(3), velocity, spin)
        for k, (velocity, spin) in enumerate(starts())
    ]
    mechanism = Mechanism(
        parts,
        {
            "JOINT_1": joints.revolute(every[21], every[1]),
            "JOINT_2": joints.revolute(*(every[n] for n in hinge)),
            "JOINT_3": joints.translational(*(every[n] for n in guide)),
            "JOINT_4": teeth(pinion, contact),
        },
        gravity=(3, -5, -7),
    )
    solution, history = played(tmp_path, "\n".join(lines)), mechanism.run(TIMES)
    for k in range(3):
        moves_alike(solution, f"PART_{k + 2}", history.part(k), 1e-6)
    for name, marker in (("JOINT_2", every[hinge[0]]), ("JOINT_3", every[guide[0]]), ("JOINT_4", pinion)):
        wanted = history.reaction(name, marker)
        near(table(solution, name), wanted, 5e-5, np.abs(wanted).max())
    on_rack = history.reaction("JOINT_4", rack)
    near(table(solution, "REQUEST_1", "f2 f3 f4 f6 f7 f8"), on_rack, 5e-5, np.abs(on_rack).max())
    axes = history.ask(lambda view: view.axes(shoe))
    seen = np.hstack([np.einsum("tij,ti->tj", axes, on_rack[:, k : k + 3]) for k in (0, 3)])
    near(table(solution, "REQUEST_2"), seen, 5e-5, np.abs(on_rack).max())


@pytest.mark.long
def test_a_rack_whose_pinion_hangs_by_primitives_is_tied_by_velocities(tmp_path):
    """ATPOINT and PARALLEL_AXES in place of the hinge: no joint counts the pinion's turns, and the motion is the same."""
    rails = "JOINT/2, TRANSLATIONAL, I=31, J=2\nJOINT/3, RACKPIN, I=21, J=32, PD=0.3"
    text = """ACCGRAV/IGRAV=9.80665
MARKER/1, PART=1
MARKER/2, PART=1, QP=0.4,-0.15,0.1, REULER=90D,90D,-90D
PART/2, MASS=1, CM=20, IP=0.02,0.03,0.04
MARKER/20, PART=2, QP=0.05,0,0
MARKER/21, PART=2
PART/3, MASS=2, CM=30, IP=0.1,0.2,0.3
MARKER/30, PART=3, QP=0.1,-0.15,0
MARKER/31, PART=3, QP=0.4,-0.15,0.1, REULER=90D,90D,-90D
MARKER/32, PART=3, QP=0,-0.15,0.2, REULER=90D,90D,-90D
"""
    ways = "JOINT/1, REVOLUTE, I=21, J=1\n", "JPRIM/1, ATPOINT, I=21, J=1\nJPRIM/2, PARALLEL, I=21, J=1\n"
    one, other = (played(tmp_path, text + way + rails) for way in ways)
    for name in ("PART_2.wz", "PART_3.x", "PART_3.ax", "JOINT_3.fx", "JOINT_3.ty", "JOINT_2.ty"):
        near(one.channels[name], other.channels[name], 1e-5)
    np.testing.assert_allclose(one.channels["JOINT_3.ty"], 0.2 * one.channels["JOINT_3.fx"], atol=1e-9)


@pytest.mark.long
def test_a_driven_rack_keeps_step_over_many_turns(tmp_path):
    """Displacements are tied, not rates: nothing is lost on the way.  The pinion's bearing feels the teeth."""
    text = """ACCGRAV/IGRAV=-9.80665
MARKER/1, PART=1
MARKER/2, PART=1, QP=0.4,-0.15,0.1, REULER=90D,90D,-90D
PART/2, MASS=1, CM=21, IP=0.02,0.03,0.04
MARKER/21, PART=2
PART/3, MASS=2, CM=30, IP=0.1,0.2,0.3
MARKER/30, PART=3, QP=0.1,-0.15,0
MARKER/31, PART=3, QP=0.4,-0.15,0.1, REULER=90D,90D,-90D
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, TRANSLATIONAL, I=31, J=2
JOINT/3, RACKPIN, I=21, J=31, PD=0.3
MOTION/1, JOINT=1, FUNCTION=360D*TIME**2"""
    solution = played(tmp_path, text, 4.0, rtol=1e-5)
    gain = 0.15 * 4 * np.pi
    pull = 2 * (gain + 9.80665)
    np.testing.assert_allclose(solution["PART_3.x"], 0.1 + gain / 2 * solution.time**2, atol=1e-10)
    np.testing.assert_allclose(solution["JOINT_3.fx"], -pull, atol=1e-8)
    np.testing.assert_allclose(solution["MOTION_1.tz"], 0.04 * 4 * np.pi + 0.15 * pull, atol=1e-8)
    np.testing.assert_allclose(solution["JOINT_1.fx"], pull + 9.80665, atol=1e-8)


def test_racks_that_are_drawn_elsewhere_are_told(tmp_path):
    text = """MARKER/1, PART=1
PART/2, MASS=1, CM=20, IP=1,1,1
MARKER/20, PART=2
PART/3, MASS=1, CM=30, IP=1,1,1
MARKER/30, PART=3, QP=0,-{drawn},0.3, REULER=90D,90D,0
JOINT/1, RACKPIN, I=20, J=30, PD=0.4
END"""
    for drawn, told in ((0.2, None), (0.3, "0.3 m from the pinion's axis"), (0, "at -y of MARKER/20")):
        path = tmp_path / "rack.adm"
        path.write_text(HEAD + text.format(drawn=drawn))
        found = [note for note in stiffmbs.load_scene(path).notes if "rack" in note]
        assert len(found) == (told is not None) and all(told in note for note in found)
