"""Handling tests of the standards: each states its manoeuvres and returns its metrics from their runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from .braking import braking_in_a_turn, of_braking_in_a_turn, of_straight_braking, straight_braking
from .car import Manoeuvre
from .known import SEEN, Known, Metrics, Run
from .lane_changes import PART_1, PART_2, highest_entry_speed, in_lanes, of_lanes
from .parameters import (
    BrakingInATurn,
    ConstantRadius,
    ConstantSpeed,
    FrequencySweep,
    LaneChange,
    ObstacleAvoidance,
    Ride,
    SineWithDwell,
    StepSteer,
    StraightBraking,
)
from .steady_state_cornering import constant_radius, constant_speed, of_constant_radius, of_constant_speed
from .steering_inputs import dwell, frequency, of_dwell, of_frequency, of_step_steer, step_steer
from .vibration import total_vibration, weighted_rms


def _rough_from(test: Ride) -> float:
    """Return the time from which all wheels are on the rough road, s."""
    return 40.0 / test.speed + 0.2


def ride(known: Known, test: Ride) -> list[Manoeuvre]:
    """Return a random road."""
    road = {
        "type": "iso8608", "roughness": test.roughness, "seed": 1, "start": 20.0, "entry": 20.0, "shortest": 0.3,
        "track": known.car.track,
    }  # fmt: skip
    return [Manoeuvre(test.speed, _rough_from(test) + test.duration, "0", road=road, output=0.005)]


def of_ride(known: Known, test: Ride, runs: list[Run]) -> Metrics:
    """Return weighted accelerations of the reference point and the dynamic wheel load."""
    run = runs[0]
    part = run["time"] >= _rough_from(test) - 1e-9
    step = float(run["time"][1] - run["time"][0])
    x, y = (weighted_rms(run[f"vehicle.{axis}"][part], step, "Wd") for axis in ("ax", "ay"))
    z = weighted_rms(run["vehicle.az"][part], step, "Wk")
    loads = [run[f"{wheel.tyre}.load"][part] for wheel in known.car.wheels.values()]
    return {
        "weighted acceleration x (Wd)": (x, "m/s^2"),
        "weighted acceleration y (Wd)": (y, "m/s^2"),
        "weighted acceleration z (Wk)": (z, "m/s^2"),
        "vibration total value": (total_vibration(x, y, z), "m/s^2"),
        "largest dynamic wheel load over its mean": (max(float(np.std(load) / np.mean(load)) for load in loads), ""),
    }


Test = TypeVar("Test")
"""Parameters of a test."""


@dataclass(frozen=True)
class HandlingTest(Generic[Test]):
    """Test of a standard."""

    title: str
    parameters: Test  # parameters with their defaults
    manoeuvres: Callable[[Known, Test], list[Manoeuvre]]  # returns the manoeuvres from `Known` and the parameters
    # returns the metrics from `Known`, the parameters and the runs of the manoeuvres
    metrics: Callable[[Known, Test, list[Run]], Metrics]
    shown: tuple[tuple[str, str], ...]  # channels on the axes of the charts of the test: across, upwards
    ramped: bool = False  # True if it needs the slow ramp at its own speed
    # returns further metrics from `Known`, the parameters, those metrics and a function that solves one manoeuvre after another
    search: Callable[[Known, Test, Metrics, Callable[[Manoeuvre], Run]], Metrics] | None = None


STEADY = (("vehicle.ay", SEEN), ("vehicle.ay", "vehicle.sideslip"), ("vehicle.ay", "vehicle.roll"))
STEERED = tuple(("time", channel) for channel in (SEEN, "vehicle.yaw_rate", "vehicle.ay", "vehicle.sideslip"))
COURSE = (("vehicle.x", SEEN), ("vehicle.x", "vehicle.ay"), ("vehicle.x", "vehicle.yaw_rate"))
BRAKED = tuple(("time", channel) for channel in ("vehicle.speed", "vehicle.ax", "vehicle.yaw_rate", "vehicle.sideslip"))
"""Channels of the charts of steady turns, of steering inputs, on courses, and of braking."""

TESTS: dict[str, HandlingTest[Any]] = {
    "constant_speed": HandlingTest("Slow ramp of steering, ISO 4138", ConstantSpeed(), constant_speed, of_constant_speed, STEADY, ramped=True),
    "constant_radius": HandlingTest("Circle, ISO 4138", ConstantRadius(), constant_radius, of_constant_radius, STEADY),
    "step_steer": HandlingTest("Step of steering, ISO 7401", StepSteer(), step_steer, of_step_steer, STEERED, ramped=True),
    "frequency_response": HandlingTest("Sweep of steering, ISO 7401", FrequencySweep(), frequency, of_frequency, STEERED, ramped=True),
    "sine_with_dwell": HandlingTest("Sine with dwell, ISO 19365", SineWithDwell(), dwell, of_dwell, STEERED, ramped=True),
    "lane_change": HandlingTest("Double lane change, ISO 3888-1", LaneChange(), in_lanes(PART_1), of_lanes(PART_1), COURSE),
    "obstacle_avoidance": HandlingTest("Obstacle avoidance, ISO 3888-2", ObstacleAvoidance(), in_lanes(PART_2), of_lanes(PART_2), COURSE, search=highest_entry_speed),
    "braking_in_a_turn": HandlingTest("Braking on a circle, ISO 7975", BrakingInATurn(), braking_in_a_turn, of_braking_in_a_turn, BRAKED),
    "straight_braking": HandlingTest("Straight-line braking, ISO 21994", StraightBraking(), straight_braking, of_straight_braking, BRAKED[:2]),
    "ride": HandlingTest("Random road, ISO 2631-1", Ride(), ride, of_ride, (("time", "vehicle.az"),)),
}  # fmt: skip
"""All tests by name."""
