"""Parts of Adams datasets: inertia in crooked axes, velocities in those of markers, links without mass, thin rods."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError

from . import adams_joints as joints
from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import HEAD, moves_alike, near, played, table

TIMES = np.linspace(0, 1, 51)


def numbers(values):
    return ", ".join(f"{value:.17g}" for value in values)


def test_a_free_part_with_inertia_and_velocities_about_and_along_other_markers(tmp_path):
    """IM elsewhere and turned, VM and WM turned; everything is carried to the centre by hand here."""
    text = """ACCGRAV/IGRAV=1, JGRAV=2, KGRAV=-3
MARKER/25, PART=2, QP=0.5,0,0, ZP=0.5,1,1, XP=1.5,0,0.2
PART/2, MASS=2.5, CM=20, IM=23, IP=1.61,1.79,1.74,0.02,-0.03,0.05
, QG=0.1,0.4,-0.3, ZG=1.1,0.4,-0.3, XG=0.1,0.4,0.7
, VX=1, VY=-2, VZ=0.5, VM=24, WX=90D, WY=1, WZ=-2, WM=25
MARKER/20, PART=2, QP=0.25,0.1,-0.15, REULER=-35D,20D,10D
MARKER/23, PART=2, QP=-0.1,0.2,0.3, REULER=60D,50D,40D
MARKER/24, PART=2, REULER=1.2,0.4,-0.3
REQUEST/1, D, I=25
REQUEST/2, F2=VX(20)\\F3=WX(20,0,24)"""
    z, x = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    body = np.column_stack([x, np.cross(z, x), z])
    center, own, other = np.array([0.25, 0.1, -0.15]), euler(-35, 20, 10), euler(60, 50, 40)
    d = center - [-0.1, 0.2, 0.3]
    about = other @ tensor(1.61, 1.79, 1.74, 0.02, -0.03, 0.05) @ other.T - 2.5 * (d @ d * np.eye(3) - np.outer(d, d))
    z = np.array([0, 1, 1]) / np.sqrt(2)
    x = np.array([1, 0, 0.2]) - (np.array([1, 0, 0.2]) @ z) * z
    x /= np.linalg.norm(x)
    spun = np.column_stack([x, np.cross(z, x), z])
    part = Part(
        2.5,
        own.T @ about @ own,
        np.array([0.1, 0.4, -0.3]) + body @ center,
        body @ own,
        body @ euler(*np.degrees([1.2, 0.4, -0.3])) @ [1, -2, 0.5],
        body @ spun @ [np.pi / 2, 1, -2],
    )
    solution, history = played(tmp_path, text), Mechanism([part], gravity=(1, 2, -3)).run(TIMES)
    moves_alike(solution, "PART_2", history.part(0))
    marker = Marker(0, np.array([0.1, 0.4, -0.3]) + body @ [0.5, 0, 0], body @ spun)
    near(table(solution, "REQUEST_1", "x y z"), history.ask(lambda view: view.point(marker).value), 1e-6)


def chain(middle, last):
    """Two links on skew hinges, the first with a brake, for the dataset and for the oracle."""
    text = f"""ACCGRAV/KGRAV=-9.80665
MARKER/1, PART=1, REULER=0,90D,0
PART/2{middle}
MARKER/20, PART=2, QP=0.2,0,0
MARKER/21, PART=2, REULER=0,90D,0
MARKER/22, PART=2, QP=0.5,0,0, REULER=40D,60D,0
PART/3, MASS=0.5, CM=30, {last}, QG=0.5,0,0
MARKER/30, PART=3, QP=0.1,0.05,-0.1
MARKER/31, PART=3, REULER=40D,60D,0
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, REVOLUTE, I=31, J=22
SFORCE/1, ROTATION, I=21, J=1, FUNCTION=-0.05*WZ(21,1,1)"""
    y, skew = euler(0, 90, 0), euler(40, 60, 0)
    own, base = Marker(0, turn=y), Marker(-1, turn=y)

    def brake(view):
        rate = view.spin(own).rate @ y[:, 2]
        view.push(own, np.zeros(3), np.zeros(3), -0.05 * rate * y[:, 2])

    def mechanism(first, inertia):
        return Mechanism(
            [first, Part(0.5, inertia, (0.6, 0.05, -0.1))],
            {
                "JOINT_1": joints.revolute(own, base),
                "JOINT_2": joints.revolute(Marker(1, (0.5, 0, 0), skew), Marker(0, (0.5, 0, 0), skew)),
            },
            [brake],
        )

    return text, mechanism, own


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    "middle", ["", *(pytest.param(each, marks=pytest.mark.long) for each in (", MASS=0, CM=20", ", CM=20, IP=0,0,0"))]
)
def test_a_link_without_mass_hands_everything_on(tmp_path, middle):
    text, mechanism, own = chain(middle, "IP=0.002,0.001,0.002")
    none = Part(0, np.zeros((3, 3)), (0.2, 0, 0))
    solution, history = played(tmp_path, text), mechanism(none, tensor(0.002, 0.001, 0.002)).run(TIMES)
    moves_alike(solution, "PART_3", history.part(1))
    near(table(solution, "JOINT_1"), history.reaction("JOINT_1", own), 1e-6)
    path = tmp_path / "trial.adm"
    assert any("PART/2 has no MASS" in note for note in stiffmbs.load_scene(path).notes)


@pytest.mark.long
def test_a_mass_without_moments_of_inertia_on_a_chain(tmp_path):
    """A point on the second link: IP is left out."""
    text, mechanism, own = chain(", MASS=1, CM=20, IP=0.1,0.2,0.3", "IP=0,0,0")
    first = Part(1, tensor(0.1, 0.2, 0.3), (0.2, 0, 0))
    solution, history = played(tmp_path, text), mechanism(first, np.zeros((3, 3))).run(TIMES)
    near(table(solution, "PART_3", "x y z"), history.ask(lambda view: view.r[1]), 2e-7)
    near(table(solution, "JOINT_1"), history.reaction("JOINT_1", own), 1e-6)


def test_a_thin_rod_on_a_ball_has_no_inertia_about_itself(tmp_path):
    """IP=0,a,a: the spherical pendulum of a point has one with the same centre and a m l^2 in place of a."""
    text = """ACCGRAV/KGRAV=-9.80665
MARKER/1, PART=1
PART/2, MASS=2, CM=20, IP=0,0.5,0.5, VY=1.2
MARKER/20, PART=2, QP=0.8,0,0
MARKER/21, PART=2
JOINT/1, SPHERICAL, I=21, J=1"""
    path = tmp_path / "rod.adm"
    path.write_text(HEAD + text + "\nEND\n")
    solution = stiffmbs.run(stiffmbs.load_scene(path), duration=1.0, output=0.02, rtol=1e-8)
    own = Marker(0)
    round_ = Part(2, tensor(0.1, 0.5, 0.5), (0.8, 0, 0), velocity=(0, 1.2, 0), spin=(0, 0, 1.5))  # it never spins
    history = Mechanism([round_], {"JOINT_1": joints.atpoint(own, Marker(-1))}).run(TIMES)
    near(table(solution, "PART_2", "x y z"), history.ask(lambda view: view.r[0]), 1e-6)
    near(table(solution, "JOINT_1", "fx fy fz"), history.reaction("JOINT_1", own)[:, :3], 1e-5)


def test_parts_without_any_mass_between_them_are_refused(tmp_path):
    path = tmp_path / "nothing.adm"
    path.write_text(HEAD + "PART/2, CM=20\nMARKER/20, PART=2\nEND\n")
    with pytest.raises(InputError, match="PART/2: found no part with a MASS"):
        stiffmbs.load_scene(path)


@pytest.mark.long
@pytest.mark.parametrize("swapped", [False, True])
def test_joints_state_how_a_chain_starts(tmp_path, swapped):
    """A turning column, a slide on it and a sleeve on that: IC, ICTRAN and ICROT, with I and J either way.

    A fourth part on a hinge without any follows the sleeve.
    """
    text = """ACCGRAV/KGRAV=-9.80665
MARKER/1, PART=1, REULER=0,20D,0
PART/2, MASS=2, CM=20, IP=0.3,0.2,0.4
MARKER/20, PART=2, QP=0.1,0.2,0.3
MARKER/21, PART=2, REULER=0,20D,0
MARKER/22, PART=2, QP=0.4,0,0.1, REULER=30D,60D,0
PART/3, MASS=1, CM=30, IP=0.1,0.2,0.15, QG=0.4,0,0.1
MARKER/30, PART=3, QP=0.2,0.1,0, REULER=10D,20D,30D
MARKER/31, PART=3, REULER=30D,60D,0
MARKER/32, PART=3, QP=0.3,0.3,0, REULER=-40D,50D,0
PART/4, MASS=1.5, CM=40, IP=0.2,0.1,0.15, QG=0.7,0.3,0.1
MARKER/40, PART=4, QP=0.1,-0.2,0.1
MARKER/41, PART=4, REULER=-40D,50D,0
"""
    pairs = {"REVOLUTE": (21, 1), "TRANSLATIONAL": (31, 22), "CYLINDRICAL": (41, 32)}
    starts = {"REVOLUTE": "IC=0,90D", "TRANSLATIONAL": "ICTRAN=0,0.6", "CYLINDRICAL": "ICROT=0,-2, ICTRAN=0,0.4"}
    for number, (kind, pair) in enumerate(pairs.items(), start=1):
        i, j = pair[::-1] if swapped else pair
        text += f"JOINT/{number}, {kind}, I={i}, J={j}, {starts[kind]}\n"
    text += "REQUEST/1, F2=WZ(21,1,1)\\F3=VZ(31,22,22,22)\\F4=WZ(41,32,32)\\F6=VZ(41,32,32,32)"
    solution = played(tmp_path, text)
    found = [solution.channels[f"REQUEST_1.{name}"][0] for name in ("f2", "f3", "f4", "f6")]
    sign = -1 if swapped else 1  # what J does against I is the opposite, in I's axes, which are parallel to J's
    np.testing.assert_allclose(found, sign * np.array([np.pi / 2, 0.6, -2, 0.4]), atol=1e-10)
    assert not any("assembly" in note for note in solution.notes)


def test_the_rest_of_a_loop_follows_a_joint_that_states_its_velocity(tmp_path):
    """A parallelogram of which one crank has IC: the coupler goes in a circle without turning."""
    text = """MARKER/1, PART=1
MARKER/2, PART=1, QP=1,0,0
PART/2, MASS=1, CM=20, IP=0.1,0.1,0.1
MARKER/20, PART=2, QP=0,0.2,0
MARKER/21, PART=2
MARKER/22, PART=2, QP=0,0.4,0
PART/3, MASS=1, CM=30, IP=0.1,0.1,0.1, QG=0,0.4,0
MARKER/30, PART=3, QP=0.5,0,0
MARKER/31, PART=3
MARKER/32, PART=3, QP=1,0,0
PART/4, MASS=1, CM=40, IP=0.1,0.1,0.1, QG=1,0,0
MARKER/40, PART=4, QP=0,0.2,0
MARKER/41, PART=4
MARKER/42, PART=4, QP=0,0.4,0
JOINT/1, REVOLUTE, I=21, J=1, IC=0,3
JOINT/2, REVOLUTE, I=31, J=22
JOINT/3, SPHERICAL, I=42, J=32
JOINT/4, REVOLUTE, I=41, J=2"""
    solution = played(tmp_path, text)
    start = {name: values[0] for name, values in solution.channels.items()}
    np.testing.assert_allclose([start["PART_2.wz"], start["PART_3.wz"], start["PART_4.wz"]], [3, 0, 3], atol=1e-9)
    np.testing.assert_allclose([start["PART_3.vx"], start["PART_3.vy"]], [-1.2, 0], atol=1e-9)


def test_a_motion_takes_precedence_over_initial_conditions(tmp_path):
    text = """MARKER/1, PART=1
PART/2, MASS=1, CM=20, IP=0.1,0.1,0.1
MARKER/20, PART=2
JOINT/1, REVOLUTE, I=20, J=1, IC=30D,5
MOTION/1, JOINT=1, FUNCTION=2*TIME"""
    solution = played(tmp_path, text)
    np.testing.assert_allclose(solution.channels["PART_2.wz"], 2, atol=1e-9)
    assert any("conditions of JOINT/1 are left out" in note for note in solution.notes)
