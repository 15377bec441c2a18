"""Manoeuvres that come with the package: the steering input against its formula, on a rack and on a steering wheel."""

import json

import numpy as np
import pytest

import stiffmbs


def steering(part, parameters, joint="prismatic"):
    """Return times and coordinate of a joint that a manoeuvre drives."""
    found = stiffmbs.read_scene(
        json.dumps(
            {
                "dimensions": 3,
                "bodies": {"moved": {"mass": 4, "inertia": [0.1, 0.2, 0.3]}},
                "joints": {"guide": {"type": joint, "i": "moved", "j": "ground"}},
                "use": {"input": {"part": part, "mounts": {"steering": "guide"}, "parameters": parameters}},
                "requests": {"seen": "guide.displacement" if joint == "prismatic" else "guide.angle"},
                "run": {"duration": 5, "output": 0.01, "rtol": 1e-8},
            }
        )
    )
    solution = stiffmbs.run(found)
    assert solution.success, solution.message
    return np.array(solution.time), np.array(solution["seen"])


@pytest.mark.parametrize(("joint", "unit", "si"), [("prismatic", "mm", 1e-3), ("revolute", "deg", np.pi / 180)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_step_of_steering(joint, unit, si, sign):
    given = {"amplitude": f"{sign * 8} {unit}", "begin": "0.5 s", "rise": "0.25 s"}
    time, seen = steering("step_steer", given, joint)
    part = np.clip((time - 0.5) / 0.25, 0, 1)
    assert seen == pytest.approx(sign * 8 * si * (10 * part**3 - 15 * part**4 + 6 * part**5), abs=1e-8)
    middle = np.interp(0.625, time, seen)
    assert middle == pytest.approx(sign * 4 * si, rel=1e-3)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_ramp_of_steering_ends_at_its_amplitude(sign):
    time, seen = steering("ramp_steer", {"amplitude": "6 mm", "rate": f"{sign * 2} mm/s"})
    assert seen == pytest.approx(sign * np.clip(2e-3 * (time - 1), 0, 6e-3), abs=1e-8)


@pytest.mark.long
@pytest.mark.parametrize(("joint", "unit", "si"), [("prismatic", "mm", 1e-3), ("revolute", "deg", np.pi / 180)])
def test_a_sine_with_dwell(joint, unit, si):
    given = {"amplitude": f"-12 {unit}", "frequency": "0.8 Hz", "dwell": "0.6 s", "begin": "0.7 s"}
    time, seen = steering("sine_with_dwell", given, joint)
    peak, period = 0.7 + 0.75 / 0.8, 1 / 0.8
    first = np.sin(2 * np.pi * 0.8 * (time - 0.7))
    last = np.sin(2 * np.pi * 0.8 * (time - 0.7 - 0.6))
    pieces = [time < 0.7, time < peak, time < peak + 0.6, time < 0.7 + period + 0.6]
    exact = np.select(pieces, [0 * time, first, -1 + 0 * time, last], 0.0)
    assert seen == pytest.approx(-12 * si * exact, abs=1e-8)


def test_defaults_are_those_of_the_standards():
    time, seen = steering("sine_with_dwell", {})
    assert np.interp(1 + 0.25 / 0.7, time, seen) == pytest.approx(10e-3, rel=1e-3)
    assert np.interp([1 + 0.76 / 0.7, 1 + 0.75 / 0.7 + 0.49], time, seen) == pytest.approx([-10e-3] * 2, rel=1e-3)
    assert seen[time > 1 + 1 / 0.7 + 0.51] == pytest.approx(0, abs=1e-9)
    time, seen = steering("step_steer", {})
    rise = np.interp([0.1, 0.9], seen[time < 1.2] / seen[-1], time[time < 1.2])
    assert np.diff(rise)[0] < 0.15
    assert seen[-1] == pytest.approx(5e-3)
