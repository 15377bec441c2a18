"""Part `brakes`: its control laws sample by sample, slips and steering on low friction, and stability in a sine with dwell."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.studies.handling import study
from stiffmbs.studies.handling.car import car_of
from stiffmbs.studies.handling.known import Known
from stiffmbs.studies.handling.metrics import sine_with_dwell
from stiffmbs.studies.handling.parameters import SineWithDwell
from stiffmbs.studies.handling.steering_inputs import dwell_end, dwell_formula

pytestmark = pytest.mark.long
WHEELS = [f"{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
MOUNTS = ", ".join(f"{w}: {w.replace('_', '.')}.wheel, {w}_upright: {w.replace('_', '.')}.upright" for w in WHEELS)
BRAKES = """  brakes: {use: brakes, on: chassis, pedal: formula, %s, mounts: {%s}, parameters: {radius: r, %s}}
  air: {use"""


def car(examples, words, parameters, steer="0 m", driver="", friction=1.0, speed="25 m/s"):
    """Return the car of the examples with the part, whose pedal its driver presses."""
    text = (examples / "car.yaml").read_text().replace("properties: car.tir", f"properties: {examples / 'car.tir'}")
    text = text.replace("  air: {use", BRAKES % (words, MOUNTS, parameters))
    text = text.replace(
        "parameters: {target: V, begins: -1 s}",
        f"braking: system\n          parameters: {{target: V, begins: -1 s, {driver}}}",
    )
    text = text.replace("parameters:\n  V", "variables: {braking: driver.braking_force}\nparameters:\n  V", 1)
    text = text.replace("course: {type: flat}", f"course: {{type: flat, friction: {friction}}}")
    text = text.replace("joint: steering.guide, position: 0 m", f'joint: steering.guide, position: "{steer}"')
    return stiffmbs.read_scene(text, [("V", speed)])


def braked(examples, words, parameters=""):
    """Return an emergency braking on a wet road with a step of steering half a second later."""
    pedal = "brakes: 1 s, pedal: 14 kN"
    scene = car(examples, words, parameters, "step5(t, 1.5, 0, 1.8, 12 mm)", pedal, friction=0.35)
    return stiffmbs.run(scene, duration=4, output=0.005)


def test_anti_lock_control_keeps_slips_low_and_the_car_steerable(examples):
    locked, free = braked(examples, "abs: none"), braked(examples, "abs: slip", "rolling_radius: r")
    fast = locked["chassis.vx"] > 6, free["chassis.vx"] > 6
    for wheel in WHEELS:
        tyre = f"{wheel.replace('_', '.')}.tyre.slip"
        assert locked[tyre][fast[0]].min() < -0.95 and free[tyre][fast[1]].min() > -0.3
    assert free["chassis.y"][-1] > 5 and abs(locked["chassis.y"][-1]) < 1
    assert free["chassis.vx"][-1] < locked["chassis.vx"][-1], "the peak of the friction is at small slips"


def test_the_torque_of_each_wheel_is_built_up_held_and_released_sample_by_sample(examples):
    """Output every 5 ms is the state just before each sample."""
    found = braked(
        examples, "abs: slip", "rolling_radius: r, holds: 0.1, releases: 0.2, builds: 4 kN m/s, dumps: 20 kN m/s"
    )
    for wheel in WHEELS:
        name = wheel.replace("_", ".")
        spin = found[f"{name}.wheel.wy"] - found[f"{name}.upright.wy"]
        speed, slip, demand, torque = (
            found[f"brakes.{wheel}_{each}"] for each in ("speed", "slip", "demand", "limited")
        )
        # the axle is nearly parallel to y of its upright
        assert slip == pytest.approx(1 - 0.3075 * spin / np.maximum(speed, 2), abs=4e-3)
        share = 0.65 if wheel.startswith("front") else 0.35
        assert demand == pytest.approx(0.3075 * share / 2 * found["brakes.demand"], abs=1e-6)
        change = np.select([slip < 0.1, slip < 0.2], [0.005 * 4e3, 0.0], -0.005 * 20e3)
        expected = np.minimum(demand, np.maximum(0, torque + change))
        fast = speed > 2
        assert torque[1:][fast[:-1]] == pytest.approx(expected[:-1][fast[:-1]], abs=1e-6)
        assert {float(x) for x in np.sign(np.round(change[fast], 9))} == {-1.0, 0.0, 1.0}


def dwelt(examples, words):
    """Return a sine with dwell of 20 mm at 80 km/h on a road of friction 0.8, and its metrics."""
    test = SineWithDwell()
    scene = car(examples, words, "", dwell_formula(0.02, test), "releases: 1 s", friction=0.8, speed="80 km/h")
    run = stiffmbs.run(scene, duration=dwell_end(test) + 2.2, output=0.01)
    metrics = sine_with_dwell(run.time, run["rack_travel"], run["yaw_rate"], run["chassis.y"], 1.0, dwell_end(test))
    q0, q1, q2, q3 = (run[f"chassis.q{k}"] for k in range(4))
    heading = np.unwrap(np.arctan2(2 * (q0 * q3 + q1 * q2), 1 - 2 * (q2**2 + q3**2)))
    return run, metrics, np.degrees(np.unwrap(np.arctan2(run["chassis.vy"], run["chassis.vx"])) - heading)


def test_stability_control_keeps_the_car_from_spinning_in_a_sine_with_dwell(examples):
    """ISO 19365: at most 35 % of the peak yaw rate 1 s after the steering, 20 % after 1.75 s, and 1.83 m to the side."""
    _, without, spun = dwelt(examples, "abs: slip, esc: none")
    run, controlled, sideslip = dwelt(examples, "abs: slip, esc: yaw_rate")
    assert not without.stable and np.abs(spun).max() > 30
    assert controlled.stable and controlled.displacement > 1.83
    assert controlled.ratio_1 < 0.05 and np.abs(sideslip).max() < 8
    speed, steer, reference, error = (
        run[f"brakes.{name}"] for name in ("speed", "steer_angle", "yaw_reference", "yaw_error")
    )
    largest = 0.85 * 9.81 / speed
    bicycle = np.clip(speed * steer / (2.7 + 3e-3 * speed**2), -largest, largest)
    assert reference[1:] == pytest.approx((reference + 0.1 * (bicycle - reference))[:-1], abs=1e-7)
    force = np.minimum(8e3, 60e3 * np.maximum(0, np.abs(error) - 0.05)) * (speed > 5)
    over = error * run["brakes.yaw_rate"] < 0
    for wheel, chosen in zip(
        WHEELS, (over & (error > 0), over & (error < 0), ~over & (error > 0), ~over & (error < 0)), strict=True
    ):
        assert run[f"brakes.{wheel}_esc"][1:] == pytest.approx(np.where(chosen, force, 0.0)[:-1], abs=1e-2)
        assert (wheel == "rear_left") or run[f"brakes.{wheel}_esc"].max() > 1e3


def test_handling_tests_press_the_pedal_of_the_brakes(examples, monkeypatch):
    """The preliminary runs are those of the car without the part."""
    scene = car(examples, "abs: slip", "rolling_radius: r", driver="pedal: 20 kN")
    known = Known(car_of(scene), per_curvature=0.342, understeer=3.85e-4, width=1.72, ramp={}, lag=0.135)
    monkeypatch.setattr(study, "_preliminary", lambda *_: known)
    found = stiffmbs.handling(scene, ["straight_braking"], workers=1)["straight_braking"]
    assert found["largest braking slip"] < 40, "wheels without anti-lock control would lock"
    assert found["mean fully developed deceleration"] > 6
