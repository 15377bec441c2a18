"""Command files that change a dataset before it is run, and those that are refused."""

import numpy as np
import pytest

import stiffmbs

G = 9.80665
HINGED = """a bar on a hinge
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/10, PART=1, QP=0,0,3, REULER=0,90D,0
PART/2, QG=0,0,3, MASS=2, CM=21, IP=0.1,0.2,0.2
MARKER/21, PART=2
MARKER/20, PART=2, QP=-1,0,0, REULER=0,90D,0
MARKER/11, PART=1, QP=-1,0,3, REULER=0,90D,0
JOINT/1, REVOLUTE, I=20, J=11
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=0.0
SPRINGDAMPER/7, TRANSLATIONAL, I=21, J=10, K=50, LENGTH=0
ACCGRAV/KGRAV=-9.80665
{}
END
"""
FREE = "DEACTIVATE/JOINT, ID=1\nDEACT/SPRINGDAMPER, ID=7\n"
RUN = "SIMULATE/DYNAMICS, END=1, DTOUT=0.1\n"


@pytest.fixture
def run_with(tmp_path):
    def run(commands, more="", **settings):
        (tmp_path / "model.adm").write_text(HINGED.format(more))
        (tmp_path / "model.acf").write_text(commands)
        return stiffmbs.run(tmp_path / "model.adm", rtol=1e-9, **settings)

    return run


@pytest.mark.long
def test_without_its_hinge_the_bar_falls_freely(run_with):
    found = run_with(FREE + RUN)
    np.testing.assert_allclose(found["PART_2.z"], 3 - G * found.time**2 / 2, atol=1e-7)
    assert found["PART_2.z"][-1] == pytest.approx(3 - G / 2, abs=1e-7)
    assert "JOINT_1.fz" not in found.channels
    assert "JOINT/1, SPRINGDAMPER/7 are deactivated by model.acf and left out" in found.notes


@pytest.mark.long
def test_without_gravity_it_stays(run_with):
    found = run_with(FREE + "ACCGRAV/KGRAV=0\n" + RUN)
    np.testing.assert_allclose(found["PART_2.z"], 3, atol=1e-12)
    assert "ACCGRAV is changed by model.acf" in found.notes


def test_a_component_of_gravity_that_is_not_given_stays(run_with):
    found = run_with(FREE + "ACCGRAV/IGRAV=2\n" + RUN)
    assert found["PART_2.x"][-1] == pytest.approx(1, abs=1e-7)
    assert found["PART_2.z"][-1] == pytest.approx(3 - G / 2, abs=1e-7)


@pytest.mark.long
def test_what_is_activated_again_holds(run_with):
    found = run_with("DEACTIVATE/JOINT, ID=1\nACTIVATE/JOINT, ID=1\n" + RUN)
    np.testing.assert_array_equal(found["PART_2.z"], run_with(RUN)["PART_2.z"])


def test_numbers_of_parts_forces_and_markers_are_changed(run_with):
    commands = FREE + "PART/2, MASS=4, VX=0.5\nSFORCE/1\n, FUNCTION=8*TIME\nMARKER/10, REULER=0,0,0\n" + RUN
    found = run_with(commands)
    t = found.time
    np.testing.assert_allclose(found["PART_2.x"], t / 2, atol=1e-7)
    np.testing.assert_allclose(found["PART_2.z"], 3 - G * t**2 / 2 + 8 / 4 * t**3 / 6, atol=1e-7)


@pytest.mark.long
def test_a_spring_is_changed(run_with):
    found = run_with("DEACTIVATE/JOINT, ID=1\nSPRINGDAMPER/7, K=8\nMARKER/10, QP=0,0,4\n" + RUN)
    t, omega, sag = found.time, 2.0, 2 * G / 8
    np.testing.assert_allclose(found["PART_2.z"], 4 - sag + (sag - 1) * np.cos(omega * t), atol=1e-6)


@pytest.mark.long
def test_it_starts_from_the_equilibrium_that_is_asked_for(run_with):
    found = run_with("DEACTIVATE/JOINT, ID=1\nSIM/STATIC\n" + RUN)
    np.testing.assert_allclose(found["PART_2.z"], 3 - 2 * G / 50, atol=1e-6)


def test_what_is_deactivated_may_be_of_a_kind_that_is_not_read(run_with):
    found = run_with("DEACTIVATE/CONTACT, ID=3\n" + FREE + RUN, "CONTACT/3, IGEOM=1, JGEOM=2")
    assert found["PART_2.z"][-1] == pytest.approx(3 - G / 2, abs=1e-7)


@pytest.mark.long
def test_two_runs_in_sequence_are_one(run_with):
    found = run_with("SIM/DYN, END=0.4, STEPS=4\nSIM/DYN, DURATION=0.6, DTOUT=0.1\n")
    np.testing.assert_allclose(found.time, np.linspace(0, 1, 11), atol=1e-12)
    np.testing.assert_allclose(found["PART_2.z"], run_with(RUN)["PART_2.z"], atol=1e-7)


@pytest.mark.parametrize(
    "commands, words",
    [
        (RUN + "SIM/DYN, END=0.5, DTOUT=0.1", "line 2, SIMULATE: found END = 0.5, expected a time after 1"),
        ("SIM/DYN, STEPS=5", "found neither END nor DURATION"),
        ("PART/2, VX=1\nSIM/STAT\n" + RUN, "found STATICS and an initial velocity of PART/2"),
        ("DEACTIVATE/JOINT, ID=4\n" + RUN, "line 1, JOINT/4: found a command for a missing statement"),
        ("DEACTIVATE/PART, ID=2\n" + RUN, "line 1, DEACTIVATE/PART: found no statement, expected one of JOINT"),
        (RUN + "SIM/KIN, END=2, DTOUT=0.1", "stage 2 of 2: kinematic"),
        (RUN + "PART/2, VX=1\nSIM/DYN, END=2", "line 2, PART/2: found VX changed between two simulations"),
        (RUN + "PART/2, QG=0,0,5\nSIM/DYN, END=2", "line 2, PART/2: found QG changed between two simulations"),
        (RUN + "JOINT/1, IC=1,1\nSIM/DYN, END=2", "line 2, JOINT/1: found IC changed between two simulations"),
        (RUN + "MARKER/21, QP=0.1,0,0\nSIM/DYN, END=2", "found a changed centre-of-mass marker of PART_2"),
        ("INTEGRATOR/HMAX=-1\n" + RUN, "line 1, INTEGRATOR: found HMAX = -1"),
        ("PART/2, MASS=heavy\n" + RUN, r"PART/2 \(changed in line 1 of the command file\): found MASS = heavy"),
        ("PART/5, MASS=1\n" + RUN, "line 1, PART/5: found a command for a missing statement"),
        ("TIME/3\n" + RUN, "line 1, TIME/3: found an unsupported command"),
        ("RELOAD/SYSTEM, FILE=a\n" + RUN, "line 1, RELOAD/SYSTEM: found an unsupported command"),
        ("CONTROL/FILE=other.acf\n" + RUN, "line 1, CONTROL: found an unsupported command"),
    ],
)  # fmt: skip
def test_what_changes_results_and_is_not_followed_is_refused(run_with, commands, words):
    with pytest.raises(stiffmbs.InputError, match=words):
        run_with(commands)


def test_changes_after_the_last_run_have_no_effect(run_with):
    found = run_with(RUN + "DEACTIVATE/JOINT, ID=1\nSTOP")
    np.testing.assert_array_equal(found["PART_2.z"], run_with(RUN)["PART_2.z"])


def test_a_motion_does_not_outlive_its_joint(run_with):
    with pytest.raises(stiffmbs.InputError, match=r"MOTION/1: found JOINT = 1"):
        run_with("DEACTIVATE/JOINT, ID=1\n" + RUN, "MOTION/1, JOINT=1, FUNCTION=TIME")


@pytest.mark.long
def test_a_motion_by_the_integral_of_a_step_is_solved_by_dynamics(run_with):
    """STEP integrated from 0 to its end at 1 s: half of 2 rad/s, in 1 s."""
    motion = "MOTION/1, JOINT=1, VELOCITY, ICDISP=0.5, FUNCTION=STEP(TIME, 0, 0, 1, 2)\nVARIABLE/1, FUNCTION=AZ(20,11)"
    found = run_with("SIMULATE/KINEMATICS, END=1, DTOUT=0.1\n", motion)
    assert found["VARIABLE_1"][[0, -1]] == pytest.approx([0.5, 1.5], abs=1e-7)
    assert "MOTION_1: integrals without a formula; KINEMATICS is solved as DYNAMICS" in found.notes
