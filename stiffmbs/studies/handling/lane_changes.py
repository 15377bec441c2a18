"""Lane changes between cones: ISO 3888-1 and 3888-2."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ...errors import InputError, SolverError
from ...model.paths.lanes import STANDARDS, Lane
from ..targets import YES_OR_NO
from .car import Manoeuvre
from .known import SEEN, Known, Metrics, Run
from .parameters import LaneChange, ObstacleAvoidance

BEFORE = 30.0
RELEASED = 2.0
"""Distance within the first lane of ISO 3888-2 after which the throttle is released, m."""
COASTING = 1.5
"""Duration of a run with the throttle released, relative to that at constant speed."""
CLEARANCE, PASSED = "least distance to a cone", f"passed{YES_OR_NO}"
ENTRY = "speed at the end of the first lane"
PART_1, PART_2 = "iso3888-1", "iso3888-2"


def in_lanes(standard: str) -> Callable[[Known, LaneChange | ObstacleAvoidance], list[Manoeuvre]]:
    """Return the function that states the manoeuvres on the course of a standard."""

    def manoeuvres(known: Known, test: LaneChange | ObstacleAvoidance) -> list[Manoeuvre]:
        """Return the course of the standard at the speed of the test."""
        path = {"lanes": standard, "width": known.width, "length": known.length, "start": BEFORE}
        duration = (STANDARDS[standard](known.width)[-1].end + BEFORE + 30) / test.speed
        driver = known.driver(test.speed)
        if standard == PART_2:
            driver["releases"], duration = (BEFORE + RELEASED) / test.speed, COASTING * duration
        return [Manoeuvre(test.speed, duration, driver=driver, path=path)]

    return manoeuvres


def of_lanes(standard: str) -> Callable[[Known, LaneChange | ObstacleAvoidance, list[Run]], Metrics]:
    """Return the function that evaluates runs on the course of a standard."""

    def metrics(known: Known, test: LaneChange | ObstacleAvoidance, runs: list[Run]) -> Metrics:
        """Return lateral error, clearance of the cones, and peaks."""
        run, lanes = runs[0], tuple(lane.shifted(BEFORE) for lane in STANDARDS[standard](known.width))
        clearance = least_clearance(lanes, known, run)
        x, speed = np.maximum.accumulate(run["vehicle.x"]), run["vehicle.speed"]
        return {
            "largest lateral error": (float(np.max(np.abs(run["handling_driver.lateral_error"]))), "m"),
            CLEARANCE: (clearance, "m"),
            PASSED: (float(clearance > 0 and x[-1] > lanes[-1].end), ""),
            "largest lateral acceleration": (float(np.max(np.abs(run["vehicle.ay"]))), "m/s^2"),
            "largest yaw rate": (float(np.max(np.abs(run["vehicle.yaw_rate"]))), "rad/s"),
            "largest steering": (float(np.max(np.abs(run[SEEN]))), "rad" if known.car.angular else "m"),
            ENTRY: (float(np.interp(lanes[0].end, x, speed)), "m/s"),
            "speed at the end of the last lane": (float(np.interp(lanes[-1].end, x, speed, right=np.nan)), "m/s"),
        }

    return metrics


def least_clearance(lanes: Sequence[Lane], known: Known, run: Run) -> float:
    """Return the least distance of the vehicle, a rectangle about its middle, to the rows of cones, m; negative over them.

    Both rows of a lane are taken as lines. Nearest to a line is a corner of the vehicle, or an end of the line is nearest
    to a side of the vehicle.
    """
    cos, sin = np.cos(run["vehicle.yaw"]), np.sin(run["vehicle.yaw"])
    ahead, left = np.subtract(known.car.middle, known.car.measured)[:2]
    x = run["vehicle.x"] + cos * ahead - sin * left
    y = run["vehicle.y"] + sin * ahead + cos * left
    found = np.inf
    for lane in lanes:
        for side, sign in ((lane.left, 1.0), (lane.right, -1.0)):
            for u in (-known.length / 2, known.length / 2):
                for v in (-known.width / 2, known.width / 2):
                    inside = (x + cos * u - sin * v >= lane.start) & (x + cos * u - sin * v <= lane.end)
                    free = sign * (side - y - sin * u - cos * v)[inside]
                    found = min(found, float(np.min(free, initial=np.inf)))
            for end in (lane.start, lane.end):
                u, v = cos * (end - x) + sin * (side - y), cos * (side - y) - sin * (end - x)
                abreast = (np.abs(u) <= known.length / 2) & (np.abs(v) <= known.length)  # not far from a car that spins
                free = sign * v[abreast] - known.width / 2
                found = min(found, float(np.min(free, initial=np.inf)))
    return found


def highest_entry_speed(
    known: Known, test: ObstacleAvoidance, metrics: Metrics, solve: Callable[[Manoeuvre], Run]
) -> Metrics:
    """Return the highest entry speed at which no cone is hit, by bisection to the resolution of the test.

    It is the speed at the end of the first lane. All lower speeds are assumed to pass, too. `metrics`: those at the speed of the
    test, which divides the interval first. A run that stops early does not pass. Raises InputError if the slowest speed does not
    pass, or the fastest one does.
    """
    found = {test.speed: metrics}

    def passes(speed: float) -> bool:
        """Return True if no cone is hit with a speed before the course, m/s."""
        one = replace(test, speed=speed)
        try:
            if speed not in found:
                found[speed] = of_lanes(PART_2)(known, one, [solve(each) for each in in_lanes(PART_2)(known, one)])
        except SolverError:
            return False
        return found[speed][PASSED][0] == 1

    speed = highest(passes, test.slowest, test.fastest, test.resolution, test.speed)
    if np.isnan(speed):
        least = found[test.slowest][CLEARANCE][0] if test.slowest in found else np.nan
        reason = f"the least distance to a cone is {least:.3g} m" if np.isfinite(least) else "the run stops early"
        raise InputError(
            f"no entry speed passes: {reason} at the slowest one, {test.slowest:.3g} m/s; reduce 'slowest', or check width, "
            "length and the driver's parameters"
        )
    if np.isinf(speed):
        raise InputError(f"the fastest entry speed passes, {test.fastest:.3g} m/s; increase 'fastest'")
    return {"highest entry speed without a cone hit": found[speed][ENTRY]}


def highest(passes: Callable[[float], bool], low: float, high: float, resolution: float, first: float) -> float:
    """Return the highest value that passes, at most a resolution below the first that does not, by bisection.

    `first`: where the interval is divided first, if it is inside. NaN if `low` does not pass, infinity if `high` does.
    """
    if not passes(low):
        return float("nan")
    if passes(high):
        return float("inf")
    middle = first if low < first < high else (low + high) / 2
    while high - low > resolution:
        low, high = (middle, high) if passes(middle) else (low, middle)
        middle = (low + high) / 2
    return low
