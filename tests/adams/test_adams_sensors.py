"""SENSOR statements, and the command files that go on after them, against integrations of their own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

G = 9.80665
PENDULUM = """a bar that lets go
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/11, PART=1, REULER=0,90D,0
PART/2, QG=1000,0,0, MASS=2, CM=21, IP=1E5,2E5,2E5
MARKER/21, PART=2
MARKER/20, PART=2, QP=-1000,0,0, REULER=0,90D,0
JOINT/1, REVOLUTE, I=20, J=11
ACCGRAV/KGRAV=-9806.65
{sensor}
END
"""


@pytest.fixture
def run_with(tmp_path):
    def run(sensor, commands="", **settings):
        (tmp_path / "model.adm").write_text(PENDULUM.format(sensor=sensor))
        if commands:
            (tmp_path / "model.acf").write_text(commands)
        return stiffmbs.run(tmp_path / "model.adm", rtol=1e-10, **settings)

    return run


def swing(event):
    """Angle below the x axis, and its rate, of the bar of 2 m that falls from the horizontal, up to an event."""
    event.terminal = True

    def rates(t, y):
        return [y[1], 2 * G * np.cos(y[0]) / 2.2]

    found = solve_ivp(rates, (0, 9), [0, 0], events=event, rtol=1e-12, atol=1e-12)
    return found.t[-1], *found.y[:, -1]


@pytest.mark.long
def test_a_bar_is_let_go_where_a_sensor_says_so(run_with):
    """The usual script: SIMULATE, then DEACTIVATE what the sensor tells, then SIMULATE up to a time."""
    found = run_with(
        "SENSOR/3, FUNCTION=DZ(21, 11), VALUE=-800, LE, ERROR=1, RETURN, CODGEN, BISECTION",
        "SIM/DYN, END=2, STEPS=8\nDEACTIVATE/SENSOR, ID=3\nDEACTIVATE/JOINT, ID=1\nSIM/DYN, END=2, STEPS=4\n",
    )
    t, angle, rate = swing(lambda t, y: np.sin(y[0]) - 0.8)
    k = int(np.flatnonzero(found["PART_2.z"] < -0.79999)[0])
    assert found.time[k] == pytest.approx(t, abs=1e-7) and found.time[k - 1] == 0.25 * (k - 1)
    np.testing.assert_allclose(found["SENSOR_3"][k], -800, atol=1e-4)
    flown = found.time[k + 1 :] - t
    speed = rate * np.array([-np.sin(angle), -np.cos(angle)])
    np.testing.assert_allclose(found["PART_2.x"][k + 1 :], np.cos(angle) + speed[0] * flown, atol=2e-6)
    np.testing.assert_allclose(found["PART_2.z"][k + 1 :], -0.8 + speed[1] * flown - G / 2 * flown**2, atol=2e-6)
    assert found.time[-1] == 2.0 and not np.any(found["JOINT_1.fz"][k + 2 :])
    assert any("ended at t = " in note and "SENSOR_3" in note for note in found.notes)
    assert "SENSOR/3: CODGEN, BISECTION left out: no effect on results" in found.notes


@pytest.mark.parametrize(
    ("sensor", "event"),
    [
        ("FUNCTION=AZ(20, 11), VALUE=50D, ANGULAR, GE, HALT", lambda t, y: np.sin(y[0]) - np.sin(np.radians(50))),
        ("FUNCTION=JOINT(1, 0, 1, 0), VALUE=50, GE, RETURN", lambda t, y: np.hypot(
            2 * (-np.sin(y[0]) * 2 * G * np.cos(y[0]) / 2.2 - np.cos(y[0]) * y[1] ** 2),
            2 * (-np.cos(y[0]) * 2 * G * np.cos(y[0]) / 2.2 + np.sin(y[0]) * y[1] ** 2) + 2 * G) - 50),
        ("FUNCTION=WY(21, 11), VALUE=3, ERROR=1E-3, EQ, RETURN", lambda t, y: y[1] - 3),
    ],
)  # fmt: skip
def test_a_run_without_commands_ends_at_its_sensor(run_with, sensor, event):
    sign = "-1*" if "AZ" in sensor else ""
    found = run_with(f"SENSOR/1, {sensor}".replace("FUNCTION=", f"FUNCTION={sign}"), duration=3, output=0.1)
    t, angle, _ = swing(event)
    assert found.time[-1] == pytest.approx(t, abs=1e-6) and found.success
    assert found["PART_2.z"][-1] == pytest.approx(-np.sin(angle), abs=1e-5)
    np.testing.assert_allclose(found.time[:-1], np.arange(len(found.time) - 1) * 0.1)


def test_no_command_is_followed_after_halt(run_with):
    found = run_with(
        "SENSOR/3, FUNCTION=TIME, VALUE=0.3, HALT",
        "SIM/DYN, END=1, STEPS=4\nACCGRAV/KGRAV=0\nSIM/DYN, DURATION=1, STEPS=4\n",
    )
    assert found.time[-1] == pytest.approx(0.3, abs=1e-9)


def test_a_sensor_that_only_restarts_the_integration_is_left_out(run_with):
    found = run_with("SENSOR/3, FUNCTION=TIME, VALUE=0.3, GE, STEPSIZE=1, RESTART", "SIM/DYN, END=1, STEPS=4\n")
    np.testing.assert_allclose(found.time, np.arange(5) / 4)
    told = "SENSOR/3 is left out: it does not end the run, and RESTART, STEPSIZE do not affect results"
    assert told in found.notes


CART = """a cart that is pushed by what a sensor has seen
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/11, PART=1
PART/2, MASS=1, CM=21, IP=1,1,1
MARKER/21, PART=2
JOINT/1, TRANSLATIONAL, I=21, J=11
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=11, FUNCTION=1 - SENVAL(5)
SENSOR/5, FUNCTION=DZ(21, 11), VALUE=0.5, {relation}, ERROR=1E-3, EVALUATE=3*VZ(21, 11)
REQUEST/1, F2=SENVAL(5)
END
"""
PIECES = [(0, 0, 0, 0), (1, 0.5, 1, 3), (2, 0.5, -1, -3), (2.5, 0.5, 1, 3), (3.5, 0.5, -1, -3), (9, 0, 0, 0)]
"""Times at which the cart passes 0.5 m with the place, its speed, and what is evaluated."""


@pytest.mark.parametrize(("relation", "last"), [pytest.param("EQ", 5, marks=pytest.mark.long), ("GE", 2)])
def test_what_a_sensor_evaluates_is_kept_until_it_counts_again(tmp_path, relation, last):
    """By GE the cart comes back once, beyond ERROR below VALUE it goes on down, so that the sensor counts no more."""
    (tmp_path / "model.adm").write_text(CART.format(relation=relation))
    found = stiffmbs.run(tmp_path / "model.adm", duration=3.8, output=0.1, rtol=1e-10)
    for (t, z, v, seen), (end, *_) in zip(PIECES[:last], [*PIECES[1:last], PIECES[-1]], strict=True):
        rows = (found.time > t + 1e-6) & (found.time < min(end, 3.81) - 1e-6)
        way = found.time[rows] - t
        np.testing.assert_allclose(found["REQUEST_1.f2"][rows], seen, atol=1e-6)
        np.testing.assert_allclose(found["PART_2.z"][rows], z + v * way + (1 - seen) / 2 * way**2, atol=1e-6)
    assert found.time[-1] == pytest.approx(3.8) and any(
        "changed at t = 1 s by 'SENSOR_5'" in note for note in found.notes
    )


def test_a_sensor_changes_the_output_and_records(run_with):
    commands = "SIM/DYN, END=1, STEPS=4\n"
    found = run_with("SENSOR/3, FUNCTION=TIME, VALUE=0.3, GE, DT=0.1, PRINT", commands)
    np.testing.assert_allclose(found.time, [0, 0.25, *np.arange(3, 11) / 10], atol=1e-9)


def test_an_inactive_sensor_keeps_what_it_has_seen(tmp_path):
    (tmp_path / "model.adm").write_text(CART.format(relation="GE"))
    (tmp_path / "model.acf").write_text(
        "SIM/DYN, END=1.5, STEPS=3\nDEACTIVATE/SENSOR, ID=5\nSIM/DYN, END=2.5, STEPS=2\n"
    )
    found = stiffmbs.run(tmp_path / "model.adm", rtol=1e-10)
    assert found["PART_2.z"][-1] == pytest.approx(0.5 + 1.5 - 1.5**2, abs=1e-6)
    assert found["REQUEST_1.f2"][-1] == pytest.approx(3, abs=1e-6)


def test_a_sensor_that_is_true_at_once_is_told(run_with):
    """It was not deactivated after it had ended the first simulation."""
    with pytest.raises(InputError, match=r"stage 2 of 2: 'SENSOR_3': found its condition true at the start, t = 0.3"):
        run_with("SENSOR/3, FUNCTION=TIME, VALUE=0.3, GE, RETURN", "SIM/DYN, END=1, STEPS=4\nSIM/DYN, END=2, STEPS=4\n")


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        ("FUNCTION=TIME, GE, RETURN", "SENSOR/1: found no VALUE, expected the number"),
        ("VALUE=1, RETURN", "SENSOR/1: found no FUNCTION"),
        ("FUNCTION=TIME, VALUE=1, GE, LE", "SENSOR/1: found GE and LE, expected one of them"),
        ("FUNCTION=USER(1), VALUE=1, RETURN", "SENSOR/1: found FUNCTION = USER\\(1\\), a user subroutine"),
        ("FUNCTION=SENVAL(2), VALUE=1, RETURN", "found SENVAL\\(2\\), expected the number of a SENSOR with EVALUATE"),
        ("FUNCTION=TIME, VALUE=1, DT=0", "found DT = 0, expected a number above zero"),
        ("FUNCTION=TIME, VALUE=1, ERROR=-1, RETURN", "found ERROR = -1, expected a number of zero or more"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_sensor_is_said(sensor, message):
    with pytest.raises(InputError, match=message):
        read_adams(PENDULUM.format(sensor=f"SENSOR/1, {sensor}"))


@pytest.mark.long
def test_a_kinematic_simulation_ends_at_a_sensor(run_with):
    found = run_with(
        "MOTION/1, ROTATIONAL, JOINT=1, FUNCTION=-1.5*TIME**2\nSENSOR/1, FUNCTION=DZ(21,11), VALUE=-500, LE, RETURN",
        "SIM/KIN, END=1, STEPS=10\nDEACT/SENSOR, ID=1\nDEACT/MOTION, ID=1\nSIM/DYN, DURATION=0.2, STEPS=2\n",
    )
    t = np.sqrt(np.pi / 6 / 1.5)
    np.testing.assert_allclose(found.time[[6, 7, 9]], [t, t, t + 0.2], atol=1e-7)
    assert found["PART_2.wy"][7] == pytest.approx(3 * t, abs=1e-6) and not np.any(found["MOTION_1.ty"][7:])


@pytest.mark.long
@pytest.mark.parametrize(("component", "expected"), [(1, 2 * G), (5, 2 * G * 1000)])
def test_reactions_in_functions_have_the_units_of_the_dataset(tmp_path, component, expected):
    """A bar of 2 kg is welded to ground at 1000 mm of its centre of mass: N and N mm, in a request and in a force."""
    function = f"1E-3*JOINT(1, 0, {component}, 0)"
    more = f"""PART/3, MASS=1, CM=31, IP=1,1,1
MARKER/31, PART=3
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=31, J=11, FUNCTION={function}
REQUEST/1, F2={function}"""
    (tmp_path / "model.adm").write_text(PENDULUM.format(sensor=more).replace("REVOLUTE", "FIXED"))
    found = stiffmbs.run(tmp_path / "model.adm", duration=0.1, points=3)
    np.testing.assert_allclose(found["REQUEST_1.f2"], 1e-3 * expected, rtol=1e-9)
    np.testing.assert_allclose(np.abs(found["PART_3.ay"]), 1e-3 * expected, rtol=1e-9)
