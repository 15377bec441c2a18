"""Command files with several simulations, against integrations of each segment that share nothing with the package."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs

from .adams_oracle import Marker, Mechanism, Part, tensor

G = 9.80665
UNITS = "segments\nUNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND\nPART/1, GROUND\n"


@pytest.fixture
def run_with(tmp_path):
    def run(dataset, commands, **settings):
        (tmp_path / "model.adm").write_text(UNITS + dataset + "END\n")
        (tmp_path / "model.acf").write_text(commands)
        return stiffmbs.run(tmp_path / "model.adm", rtol=1e-10, **settings)

    return run


BAR = """MARKER/11, PART=1, REULER=0,90D,0
PART/2, QG=1,0,0, MASS=2, CM=21, IP=0.1,0.2,0.3
MARKER/21, PART=2
MARKER/20, PART=2, QP=-1,0,0, REULER=0,90D,0
JOINT/1, REVOLUTE, I=20, J=11
SFORCE/1, ROTATIONAL, ACTIONONLY, I=20, J=11, FUNCTION=2*SIN(3*TIME)
REQUEST/1, F2=JOINT(1,0,4,0)
ACCGRAV/KGRAV=-9.80665
"""


def hinged(view):
    """A pin along y at the origin of a bar of 2 m whose middle is 1 m from it."""
    pin, arm = view.point(Marker(0)), view.fixed(0, (0.0, 1.0, 0.0))
    return np.column_stack([pin.second, arm.second[:, [0, 2]]]).T


def along(parts, joints, gravity, start, times, torque):
    """States of one bar with a torque about -y, from a start in the oracle's own coordinates."""
    mechanism = Mechanism(parts, joints, [torque], gravity)
    found = solve_ivp(mechanism._rates, (times[0], times[-1]), start, "DOP853", t_eval=times, rtol=1e-12, atol=1e-12)
    return found.y.T


def test_a_hinge_is_let_go_and_gravity_turned(run_with):
    """Three segments: on its hinge, free with the same torque, then with other gravity and mass."""
    found = run_with(
        BAR,
        "SIM/DYN, END=0.4, STEPS=4\nDEACTIVATE/JOINT, ID=1\nSIM/DYN, DURATION=0.3, STEPS=3\n"
        "ACCGRAV/IGRAV=5\nPART/2, MASS=3, IP=0.1,0.5,0.3\nSIM/DYN, END=1, DTOUT=0.1\n",
    )

    def torque(view):
        view.push(Marker(0), view.r[0], (0, 0, 0), (0, -2 * np.sin(3 * view.t), 0))

    bar = Part(2, tensor(0.1, 0.2, 0.3), (1, 0, 0))
    heavy = Part(3, tensor(0.1, 0.5, 0.3), (1, 0, 0))
    start = Mechanism([bar])._start()
    first = along([bar], {"hinge": hinged}, (0, 0, -G), start, np.linspace(0, 0.4, 5), torque)
    second = along([bar], {}, (0, 0, -G), first[-1], np.linspace(0.4, 0.7, 4), torque)
    third = along([heavy], {}, (5, 0, -G), second[-1], np.linspace(0.7, 1.0, 4), torque)
    rows = np.concatenate([first, second, third])
    np.testing.assert_allclose(found.time, [*np.arange(5) / 10, *np.arange(4, 8) / 10, *np.arange(7, 11) / 10])
    for k, name in enumerate("xyz"):
        np.testing.assert_allclose(found[f"PART_2.{name}"], rows[:, k], atol=2e-8)
        np.testing.assert_allclose(found[f"PART_2.v{name}"], rows[:, 7 + k], atol=2e-7)
    spin = np.array([found[f"PART_2.w{name}"] for name in "xyz"])
    np.testing.assert_allclose(np.linalg.norm(spin, axis=0), np.linalg.norm(rows[:, 10:], axis=1), atol=2e-7)
    assert np.all(found["JOINT_1.fz"][:5] > 0) and not np.any(found["JOINT_1.fz"][5:])
    np.testing.assert_allclose(found["REQUEST_1.f2"], found["JOINT_1.fz"], atol=1e-9)
    assert "from simulation 2 on JOINT/1 is deactivated by model.acf and left out" in found.notes


def pendulum(times, angle, rate, pull):
    """Angle of the bar from the x axis towards -z over time, by an integration of its own."""

    def rates(t, y):
        return [y[1], (2 * G * np.cos(y[0]) + pull(t)) / (0.2 + 2)]

    return solve_ivp(rates, (times[0], times[-1]), [angle, rate], t_eval=times, rtol=1e-12, atol=1e-12).y


def test_a_crank_is_driven_then_let_go_then_driven_again(run_with):
    """KINEMATIC by a motion, DYNAMIC without it, and DYNAMIC under another motion through the angle that is reached."""
    found = run_with(
        BAR + "MOTION/5, ROTATIONAL, JOINT=1, FUNCTION=-1.5*TIME**2\n",
        "SIM/KIN, END=0.5, STEPS=5\nDEACT/MOTION, ID=5\nSIM/DYN, END=0.9, STEPS=4\nACT/MOTION, ID=5\nMOTION/5, VELOCITY, FUNCTION=-1.5\n"
        "SIM/TRANSIENT, END=1.4, STEPS=5",
    )
    first = np.linspace(0, 0.5, 6)
    angle, rate = pendulum(np.linspace(0.5, 0.9, 5), 1.5 * 0.25, 1.5, lambda t: -2 * np.sin(3 * t))
    last = angle[-1] + 1.5 * np.linspace(0, 0.5, 6)
    angles = np.concatenate([1.5 * first**2, angle[1:], last])
    np.testing.assert_allclose(found.time[[5, 6, 10, 11]], [0.5, 0.5, 0.9, 0.9])
    rows = np.delete(
        np.arange(len(found.time)), 6
    )  # the first row of the second segment has the state of the row before
    np.testing.assert_allclose(found["PART_2.z"][rows], -np.sin(angles), atol=1e-7)
    np.testing.assert_allclose(found["PART_2.x"][rows], np.cos(angles), atol=1e-7)
    np.testing.assert_allclose(found["PART_2.wy"][7:11], rate[1:], atol=1e-6)
    np.testing.assert_allclose(found["PART_2.wy"][11:], 1.5, atol=1e-9)
    assert np.all(found["MOTION_5.ty"][6:11] == 0)


COLLISION = """MARKER/10, PART=1, REULER=0,90D,0
PART/2, MASS=2, CM=21, IP=0.1,0.1,0.1, VX=3
MARKER/21, PART=2
PART/3, QG=1.5,0,0, MASS=1, CM=31, IP=0.1,0.1,0.1
MARKER/31, PART=3
JOINT/1, FIXED, I=21, J=31
SPRINGDAMPER/1, TRANSLATIONAL, I=31, J=10, K=40, C=0.5, LENGTH=1
"""


@pytest.mark.long
def test_parts_that_are_joined_on_the_way_go_on_together_and_settle(run_with):
    """Momentum is kept where a joint becomes active; then oscillation, an equilibrium, and another one under gravity."""
    found = run_with(
        COLLISION.replace("K=40", "K=0").replace("C=0.5", "C=0"),
        "DEACT/JOINT, ID=1\nSIM/DYN, END=0.5, STEPS=1\nACT/JOINT, ID=1\nSPRINGDAMPER/1, K=40, C=0.5\nSIM/DYN, END=1, STEPS=5\n"
        "SIM/STAT\nACCGRAV/IGRAV=4\nSIM/STAT, END=3, STEPS=2\nSIM/DYN, END=3.5, STEPS=1",
    )
    times = np.linspace(0.5, 1, 6)
    own = solve_ivp(
        lambda t, y: [y[1], (-40 * (y[0] - 1) - 0.5 * y[1]) / 3],
        (0.5, 1),
        [1.5, 2.0],
        t_eval=times,
        rtol=1e-12,
        atol=1e-12,
    )
    joined = slice(2, 8)
    assert found["PART_3.vx"][1] == pytest.approx(0, abs=1e-12) and found["PART_3.vx"][2] == pytest.approx(2)
    np.testing.assert_allclose(found.time[joined], times)
    np.testing.assert_allclose(found["PART_3.x"][joined], own.y[0], atol=1e-7)
    np.testing.assert_allclose(found["PART_2.vx"][joined], own.y[1], atol=1e-6)
    assert found.time[8] == 1 and found["PART_3.x"][8] == pytest.approx(1)
    np.testing.assert_allclose(found["PART_3.x"][9:], 1 + 3 * 4 / 40, atol=1e-6)
    np.testing.assert_allclose(found.time[9:], [1, 2, 3, 3.5])
    assert "all velocities are zero after a static simulation" in found.notes


def test_the_integrator_is_asked_for_small_steps_and_small_errors(run_with, tmp_path):
    run_with(
        COLLISION,
        "INTEGRATOR/ERROR=1E-3, HMAX=0.01\nSIM/DYN, END=1, STEPS=10\nINTEG/SI2, ERR=1E-9\nSIM/DYN, END=2, STEPS=10",
    )
    first, second = (stage.run for stage in stiffmbs.load_scene(tmp_path / "model.adm").stage_scenes)
    assert (first.max_step, first.rtol) == (0.01, 1e-6) and (second.max_step, second.rtol) == (0.01, 1e-9)


def test_only_a_static_simulation_has_one_row(run_with):
    found = run_with(BAR, "SIM/STAT")
    np.testing.assert_allclose(found.time, [0])
    assert found["PART_2.z"][0] == pytest.approx(-1)


def test_a_converted_scene_has_the_same_stages(run_with, tmp_path):
    found = run_with(
        BAR, "SIM/STAT\nACCGRAV/IGRAV=5\nSIM/DYN, END=0.4, STEPS=4\nDEACTIVATE/JOINT, ID=1\nSIM/DYN, END=0.8, STEPS=4\n"
    )
    from stiffmbs.adams.load import convert_file

    (tmp_path / "scene.yaml").write_text(convert_file(tmp_path / "model.adm"))
    again = stiffmbs.run(tmp_path / "scene.yaml", rtol=1e-10)
    np.testing.assert_allclose(again["PART_2.x"], found["PART_2.x"], rtol=0, atol=1e-14)


def test_kinematics_under_a_driven_velocity_stay_kinematics(run_with):
    """A motion by its velocity, and another one from where it ends; with a freedom left there is no kinematic analysis."""
    text = BAR + "MOTION/5, ROTATIONAL, JOINT=1, VELOCITY, FUNCTION=-1.5-TIME\n"
    found = run_with(text, "SIM/KIN, END=0.5, STEPS=5\nMOTION/5, VELOCITY, FUNCTION=-2\nSIM/KIN, END=1, STEPS=5\n")
    first = np.linspace(0, 0.5, 6)
    angles = np.concatenate([1.5 * first + first**2 / 2, 0.875 + 2 * first])
    np.testing.assert_allclose(found["PART_2.z"], -np.sin(angles), atol=1e-10)
    np.testing.assert_allclose(found["PART_2.wy"][[0, -1]], [1.5, 2], atol=1e-10)
    with pytest.raises(stiffmbs.InputError, match="independent equations for 6 velocities"):
        run_with(BAR, "SIM/KIN, END=0.5, STEPS=5")
