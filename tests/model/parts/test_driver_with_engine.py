"""The driver with engine, gearbox and brakes: a speed profile along a course, gear changes, and stability control by the throttle."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.reading.files.yaml_text import read_yaml

pytestmark = pytest.mark.long
WHEELS = [f"{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
GEARS = {1: 3.6, 2: 2.1, 3: 1.4, 4: 1.05}
PROFILE = [[0, 8], [10, 8], [200, 21], [220, 21], [400, 10], [600, 10]]
POINTS = [[0, 0], [20, 0], [40, 0], [120, 4], [200, 0], [280, -4], [360, 0], [440, 3], [520, 0], [700, 0]]


def car(examples, speed, gear, driver, esc="none", throttle="driver.throttle_position"):
    """Return the entries of the car of the examples with engine, driveline and brakes."""
    entries = read_yaml((examples / "car.yaml").read_text(), "car.yaml")
    circle = entries["options"].pop("manoeuvre")["circle"]
    mounts = {wheel: f"{wheel.replace('_', '.')}.wheel" for wheel in WHEELS}
    uprights = {f"{wheel}_upright": f"{wheel.replace('_', '.')}.upright" for wheel in WHEELS}
    engine = {"start_speed": f"{GEARS[gear]}*3.5*V/r", "start_gear": gear}
    entries["parts"] |= {
        "driver": {**circle["parts"]["driver"], "drive": "engine", "braking": "system", **driver},
        "driveline": {
            "use": "driveline", "on": "chassis", "drive": "rear", "position": [0, 0, "-height"], "mounts": mounts,
            "parameters": {"speed": "V", "rolling_radius": "r"},
        },
        "engine": {
            "use": "powertrain", "on": "chassis", "mounts": {"output": "driveline.main.input"}, "throttle": "formula",
            "gear": "automatic", "parameters": engine,
        },
        "brakes": {
            "use": "brakes", "on": "chassis", "pedal": "formula", "abs": "slip", "esc": esc, "mounts": {**mounts, **uprights},
            "parameters": {"radius": "r", "rolling_radius": "r"},
        },
    }  # fmt: skip
    entries["variables"] = {"throttle": throttle, "braking": "driver.braking_force"}
    entries["parameters"]["V"] = speed
    entries["roads"] = circle["roads"]
    entries["start"]["rolling"].append("driveline.main.input")
    for tyre in entries["forces"].values():
        tyre["properties"] = str(examples / "car.tir")
    return entries


def test_a_speed_profile_is_kept_along_a_course_through_all_its_gears(examples):
    """Within 0.8 m/s at up to 1.4 m/s^2: the driver opens the throttle, or presses the pedal, by the missing speed."""
    entries = car(examples, "8 m/s", 1, {"pace": "profile", "parameters": {"target": "V", "begins": -1}})
    entries["path"] = {"points": POINTS, "speed": PROFILE}
    run = stiffmbs.run(stiffmbs.read_scene(json.dumps(entries)), duration=31, output=0.05)
    assert run.success and run["driver.station"][-1] > 400
    speed, goal = run["driver.speed"], run["driver.goal"]
    assert np.max(np.abs(speed - goal)) < 0.8
    assert np.max(np.abs(run["driver.lateral_error"])) < 0.15
    assert goal.max() == pytest.approx(21, abs=1e-6) and goal[-1] == pytest.approx(10, abs=0.01)
    chosen, turns = np.round(run["engine.chosen_gear"]), run["engine.chosen_speed"] * 30 / np.pi
    shifts = np.flatnonzero(np.diff(chosen))
    assert [int(gear) for gear in chosen[np.append(shifts, -1)]] == [1, 2, 3, 2]
    up = np.diff(chosen)[shifts] > 0
    assert np.all(turns[shifts[up]] > 4400) and np.all(turns[shifts[~up]] < 1900), "by the thresholds of the part"
    settled = np.abs(run["engine.gear_now"] - chosen) < 1e-3
    ratio = np.array([GEARS[int(gear)] for gear in chosen])
    spin = run["rear.left.wheel.wy"] + run["rear.right.wheel.wy"]
    steady = settled & (run.time > 1)
    expected = ratio * 3.5 * spin / 2
    assert np.median(np.abs(run["engine.engine_speed"][steady] / expected[steady] - 1)) < 5e-3
    assert np.all((run["engine.engine_speed"] > 89) & (run["engine.engine_speed"] < 680)), "idle and limiter"
    assert not np.any((run["engine.opening"] > 0.05) & (-run["driver.brake"] > 200)), "never both pedals"


def test_stability_control_closes_the_throttle_in_power_oversteer(examples):
    """Full throttle in a turn on ice: brakes alone do not keep the car from spinning, the throttle's limit does."""
    found = {}
    for throttle in ("driver.throttle_position", "min(driver.throttle_position, brakes.throttle_limit)"):
        driver = {"path": "none", "parameters": {"target": "V", "begins": -1, "acceleration": 4, "accelerates": 1}}
        entries = car(examples, "10 m/s", 2, driver, "yaw_rate", throttle)
        entries["roads"]["course"]["friction"] = 0.3
        entries["joints"] = {
            "steer": {"type": "drive", "joint": "steering.guide", "position": "step5(t, 0.5, 0, 1, 8 mm)"}
        }
        found["min" in throttle] = stiffmbs.run(stiffmbs.read_scene(json.dumps(entries)), duration=4, output=0.01)
    open_, limited = found[False], found[True]
    assert np.max(np.abs(open_["brakes.yaw_error"])) > 1, "it spins"
    assert np.max(np.abs(limited["brakes.yaw_error"])) < 0.25
    limit, error = limited["brakes.throttle_limit"], np.abs(limited["brakes.yaw_error"])
    expected = np.minimum(limit + 0.01 / 0.5, np.clip(1 - 60e3 / 8e3 * (error - 0.05), 0, 1))
    assert limit[1:] == pytest.approx(expected[:-1], abs=1e-5)
    assert limit.min() == 0 and limit.max() == 1
    assert np.max(limited["engine.opening"] - limit) < 1e-9


def test_without_stability_control_the_throttle_has_no_limit(examples):
    entries = car(examples, "10 m/s", 2, {"path": "none", "parameters": {"target": "V", "begins": -1}})
    entries["joints"] = {"steer": {"type": "drive", "joint": "steering.guide", "position": 0}}
    run = stiffmbs.run(stiffmbs.read_scene(json.dumps(entries)), duration=0.2, output=0.1)
    assert run["brakes.throttle_limit"] == pytest.approx(1)


def test_a_gear_that_has_been_reached_has_no_breakpoint_at_rest(examples):
    """Ratios with a kink at each gear restarted the integrator at every crossing by rounding: 8600 steps in place of 2000."""
    entries = car(examples, "13 m/s", 1, {"path": "none", "parameters": {"target": "V", "begins": -1}})
    entries["joints"] = {"steer": {"type": "drive", "joint": "steering.guide", "position": 0}}
    run = stiffmbs.run(stiffmbs.read_scene(json.dumps(entries)), duration=3, output=0.1)
    assert list(np.round(run["engine.chosen_gear"][[0, -1]])) == [1, 2]
    assert run["engine.gear_ratio"][-1] == pytest.approx(2.1, rel=1e-12), "flat where the gearbox rests"
    assert run.solver["steps"] < 4000
