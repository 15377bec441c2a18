"""Initial displacements and velocities of joints that differ from what is drawn."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.adams.load import convert_file

from .adams_joints import revolute
from .adams_oracle import Marker, Mechanism, Part, tensor
from .adams_trials import near, played

ACROSS = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T  # REULER = 0, -90D, 0: z along y
TEXT = """!
PART/2, QG = 500, 0, 0
, MASS = 2, CM = 21, IP = 1E4, 2E5, 2E5
MARKER/21, PART = 2
MARKER/22, PART = 2, QP = -500, 0, 0, REULER = 0, -90D, 0
MARKER/23, PART = 2, QP = 500, 0, 0, REULER = 0, -90D, 0
MARKER/11, PART = 1, REULER = 0, -90D, 0
PART/3, QG = 1300, 0, 0
, MASS = 1, CM = 31, IP = 1E4, 1E5, 1E5
MARKER/31, PART = 3
MARKER/32, PART = 3, QP = -300, 0, 0, REULER = 0, -90D, 0
JOINT/1, REVOLUTE, I = 22, J = 11
, IC = {first}
JOINT/2, REVOLUTE, I = 32, J = 23
, IC = {second}
ACCGRAV/KGRAV = -9806.65
"""
HEAD = "joint starts\nUNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND\nPART/1, GROUND\n"


def leaning(angle):
    """A turn about y."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


@pytest.mark.long
def test_a_double_pendulum_starts_at_the_angles_of_its_joints(tmp_path):
    """Both angles and their rates are those of JOINT, though parts are drawn on a line and at rest."""
    solution = played(tmp_path, TEXT.format(first="30D, 1.5", second="-0.8, 2"), 0.5, HEAD)
    a, b = np.radians(30), np.radians(30) - 0.8
    one, other, spin = leaning(a), leaning(b), np.array([0, 1, 0])
    knee, velocity = one @ [1, 0, 0], np.cross(1.5 * spin, one @ [1, 0, 0])
    first = Part(2, tensor(0.01, 0.2, 0.2), tuple(one @ [0.5, 0, 0]), one, tuple(velocity / 2), tuple(1.5 * spin))
    arm = other @ [0.3, 0, 0]
    second = Part(
        1,
        tensor(0.01, 0.1, 0.1),
        tuple(knee + arm),
        other,
        tuple(velocity + np.cross(3.5 * spin, arm)),
        tuple(3.5 * spin),
    )
    joints = {
        "hinge": revolute(Marker(0, (0, 0, 0), ACROSS), Marker(-1, (0, 0, 0), ACROSS)),
        "knee": revolute(Marker(1, tuple(knee), ACROSS), Marker(0, tuple(knee), ACROSS)),
    }
    history = Mechanism([first, second], joints).run(solution.time)
    for k, part in enumerate(("PART_2", "PART_3")):
        wanted = history.part(k)
        for name in ["x", "z", "vx", "vz", "ax", "az", "wy"]:
            near(solution[f"{part}.{name}"], wanted[name], 2e-5)
    assert any("JOINT_1_turn_position, JOINT_1_turn_velocity" in note and "assembly" in note for note in solution.notes)


def test_a_displacement_alone_leaves_the_velocity_as_the_parts_have_it(tmp_path):
    """The slide is moved to 0.2 m; its part goes on with the velocity that PART states."""
    text = """PART/2, MASS=2, CM=21, IP=1,1,1, VX=3
MARKER/21, PART=2, REULER=90D,90D,0
MARKER/11, PART=1, REULER=90D,90D,0
JOINT/1, TRANSLATIONAL, I=21, J=11, IC=0.2
"""
    solution = played(tmp_path, text, 0.5)
    np.testing.assert_allclose(solution["PART_2.x"], 0.2 + 3 * solution.time, atol=1e-9)
    again = tmp_path / "again.yaml"
    again.write_text(convert_file(tmp_path / "trial.adm"))
    found = stiffmbs.run(again, duration=0.5, output=0.02, rtol=1e-8)
    np.testing.assert_allclose(found["PART_2.x"], solution["PART_2.x"], atol=1e-12)


@pytest.mark.long
def test_joints_overrule_velocities_of_parts_that_contradict_them(tmp_path):
    """The hinge turns at 2 rad/s against a part that says 3; the free direction keeps what the part says."""
    text = """PART/2, MASS=2, CM=21, IP=1,1,1, WZ=3, VZ=1
MARKER/21, PART=2
MARKER/11, PART=1
JOINT/1, CYLINDRICAL, I=21, J=11, ICROT=0,2
"""
    solution = played(tmp_path, text, 0.1)
    np.testing.assert_allclose(solution["PART_2.wz"], 2, atol=1e-9)
    np.testing.assert_allclose(solution["PART_2.vz"], 1, atol=1e-9)
