"""The driver with engine, gearbox and brakes: a speed profile along a course, gear changes, and stability control by the throttle."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.reading.files.yaml_text import read_yaml

pytestmark = pytest.mark.long
WHEELS = [f"{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
GEARS = {1: 3.6, 2: 2.1, 3: 1.4, 4: 1.05}
PROFILE = [[0, 6], [30, 6], [230, 19], [330, 19], [480, 8], [700, 8]]
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
