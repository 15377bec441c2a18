"""Braking on a circle, ISO 7975, and straight ahead, ISO 21994."""

from __future__ import annotations

import numpy as np

from .car import Manoeuvre
from .known import Known, Metrics, Run
from .metrics import mean_deceleration, yaw_rate_ratio
from .parameters import BrakingInATurn, StraightBraking
from .steady_state_cornering import circle

BEFORE_BRAKING = 201.0
"""Way before braking in a turn, m: entry, transition and a steady part of the circle."""


def _turn(test: BrakingInATurn) -> tuple[float, float]:
    """Return the speed on the circle, m/s, and the time at which braking begins, s."""
    speed = float(np.sqrt(test.lateral_acceleration * test.radius))
    return speed, round(BEFORE_BRAKING / speed, 1)


def _pressed(pedal: float | None) -> dict[str, float]:
    """Return the driver's parameters of a pedal; none where the driver's own apply."""
    return {} if pedal is None else {"pedal": pedal}


def _moving(speed: np.ndarray) -> np.ndarray:
    """Return True down to a tenth of the first speed, as in the mean deceleration: anti-lock control ends at a few m/s."""
    moving: np.ndarray = speed > 0.1 * speed[0]
    return moving


def braking_in_a_turn(known: Known, test: BrakingInATurn) -> list[Manoeuvre]:
    """Return braking on a circle with the steering held."""
    speed, brakes = _turn(test)
    driver = {**known.driver(speed), "brakes": brakes, "holds": brakes - 0.2, "pressing": 0.2, **_pressed(test.pedal)}
    duration = brakes + 3.0
    return [Manoeuvre(speed, duration, driver=driver, path=circle(test.radius, 60.0, speed * duration))]


def of_braking_in_a_turn(known: Known, test: BrakingInATurn, runs: list[Run]) -> Metrics:
    """Return the reaction of the yaw rate, deceleration and sideslip after braking begins."""
    run, begin = runs[0], _turn(test)[1]
    yaw_rate, speed = run["vehicle.yaw_rate"], run["vehicle.speed"]
    after = (run["time"] >= begin) & _moving(speed)
    one = int(np.searchsorted(run["time"], begin + 1.0))
    return {
        "lateral acceleration before": (float(np.interp(begin - 0.2, run["time"], run["vehicle.ay"])), "m/s^2"),
        "deceleration 1 s after": (float(-run["vehicle.ax"][one]), "m/s^2"),
        "yaw rate ratio 1 s after": (yaw_rate_ratio(run["time"], yaw_rate, speed, begin), ""),
        "largest yaw rate over that before": (
            float(np.max(yaw_rate[after]) / np.interp(begin, run["time"], yaw_rate)),
            "",
        ),
        "largest sideslip": (float(np.degrees(np.max(np.abs(run["vehicle.sideslip"][after])))), "deg"),
    }


def straight_braking(known: Known, test: StraightBraking) -> list[Manoeuvre]:
    """Return braking straight ahead with the pedal pressed."""
    duration = 12.0 * max(1.0, test.speed / (100 / 3.6))
    return [Manoeuvre(test.speed, duration, driver={"brakes": 1.0, **_pressed(test.pedal)})]


def of_straight_braking(known: Known, test: StraightBraking, runs: list[Run]) -> Metrics:
    """Return mean fully developed deceleration, stopping distance and the largest slip."""
    run = runs[0]
    part = run["time"] >= 1.0
    time, speed = run["time"][part], run["vehicle.speed"][part]
    slip = min(float(np.min(run[f"{wheel.tyre}.slip"][part][_moving(speed)])) for wheel in known.car.wheels.values())
    distance = np.sum((speed[1:] + speed[:-1]) / 2 * np.diff(time))
    return {
        "mean fully developed deceleration": (mean_deceleration(time, speed), "m/s^2"),
        "distance": (float(distance), "m"),
        "largest braking slip": (-100 * slip, "%"),
        "lateral deviation": (float(np.max(np.abs(run["vehicle.y"] - run["vehicle.y"][0]))), "m"),
    }
