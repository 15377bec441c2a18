"""Lane changes between cones: ISO 3888-1 and 3888-2."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...errors import SolverError
from ...model.paths.curves import curve_through
from ...model.paths.lanes import STANDARDS, path_through
from .car import Manoeuvre
from .known import SEEN, Known, Metrics, Run
from .parameters import LaneChange, ObstacleAvoidance

BEFORE = 30.0
PART_1, PART_2 = "iso3888-1", "iso3888-2"


def in_lanes(standard: str) -> Callable[[Known, LaneChange | ObstacleAvoidance], list[Manoeuvre]]:
    """Return the function that states the manoeuvres on the course of a standard."""

    def manoeuvres(known: Known, test: LaneChange | ObstacleAvoidance) -> list[Manoeuvre]:
        """Return the course of the standard at the speed of the test."""
        path = {"lanes": standard, "width": known.width, "start": BEFORE}
        length = STANDARDS[standard](known.width)[-1].end + BEFORE + 30
        return [Manoeuvre(test.speed, length / test.speed, driver=known.driver(), path=path)]

    return manoeuvres


def of_lanes(standard: str) -> Callable[[Known, LaneChange | ObstacleAvoidance, list[Run]], Metrics]:
    """Return the function that evaluates runs on the course of a standard."""

    def metrics(known: Known, test: LaneChange | ObstacleAvoidance, runs: list[Run]) -> Metrics:
        """Return lateral error, clearance of the cones, and peaks."""
        run, lanes = runs[0], tuple(lane.shifted(BEFORE) for lane in STANDARDS[standard](known.width))
        course = curve_through(path_through(lanes, known.width, BEFORE, 100.0))
        x, y = run["vehicle.x"], run["vehicle.y"]
        clearance = np.inf
        for lane in lanes:
            inside = (x >= lane.start) & (x <= lane.end)
            for side, sign in ((lane.left, 1.0), (lane.right, -1.0)):
                free = sign * (side - y[inside]) - known.width / 2
                clearance = min(clearance, float(np.min(free, initial=np.inf)))
        return {
            "largest lateral error": (float(np.max(np.abs(course.nearest(x, y)[1]))), "m"),
            "least distance to a cone": (clearance, "m"),
            "passed (1 yes, 0 no)": (float(clearance > 0 and x[-1] > lanes[-1].end), ""),
            "largest lateral acceleration": (float(np.max(np.abs(run["vehicle.ay"]))), "m/s^2"),
            "largest yaw rate": (float(np.max(np.abs(run["vehicle.yaw_rate"]))), "rad/s"),
            "largest steering": (float(np.max(np.abs(run[SEEN]))), "rad" if known.car.angular else "m"),
            "speed at the end": (float(run["vehicle.speed"][-1]), "m/s"),
        }

    return metrics


def highest_entry_speed(known: Known, test: ObstacleAvoidance, solve: Callable[[Manoeuvre], Run]) -> Metrics:
    """Return the highest entry speed at which no cone is hit, by bisection to the resolution of the test.

    All lower speeds are assumed to pass, too. A run that stops early does not pass. The value is NaN if the slowest
    speed does not pass, and infinite if the fastest one does.
    """

    def passes(speed: float) -> bool:
        """Return True if no cone is hit at an entry speed, m/s."""
        one = replace(test, speed=speed)
        try:
            runs = [solve(each) for each in in_lanes(PART_2)(known, one)]
        except SolverError:
            return False
        return of_lanes(PART_2)(known, one, runs)["passed (1 yes, 0 no)"][0] == 1

    found = highest(passes, test.slowest, test.fastest, test.resolution)
    return {"highest entry speed without a cone hit": (found, "m/s")}


def highest(passes: Callable[[float], bool], low: float, high: float, resolution: float) -> float:
    """Return the highest value that passes, at most a resolution below the first that does not, by bisection.

    NaN if `low` does not pass, infinity if `high` does.
    """
    if not passes(low):
        return float("nan")
    if passes(high):
        return float("inf")
    while high - low > resolution:
        middle = (low + high) / 2
        low, high = (middle, high) if passes(middle) else (low, middle)
    return low
