"""Charts of handling tests as SVG: channels over time or over each other, courses with cones, and frequency responses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.paths.lanes import STANDARDS, path_through
from ..reading.units.display import DisplayUnits
from ..studies.handling.known import SEEN, Run
from ..studies.handling.lane_changes import BEFORE, PART_1, PART_2
from ..studies.handling.metrics import at_zero
from ..studies.handling.standards import TESTS
from ..studies.handling.steering_inputs import response_of_sweeps
from ..studies.handling.study import Handling
from .curves import Curve, curve_chart
from .page.page_of_tests import written_unit

COURSES = {"lane_change": PART_1, "obstacle_avoidance": PART_2}
"""Courses with cones, by test."""
RAMP = "constant_speed"
"""Test whose charts show the tangents at zero lateral acceleration."""


@dataclass(frozen=True)
class Quantity:
    """Channel on an axis: its name, SI unit, and its values of a run of a car."""

    name: str
    unit: str
    values: Callable[[Handling, Run], np.ndarray]

    def title(self, display: DisplayUnits) -> str:
        """Return the name with the unit in which it is shown."""
        return f"{self.name}, {written_unit(display.of(self.unit)[0])}"


def _channel(name: str, unit: str, channel: str) -> Quantity:
    return Quantity(name, unit, lambda found, run: run[channel])


QUANTITIES = {
    "time": _channel("time", "s", "time"), SEEN: Quantity("steer angle of the wheels", "rad", lambda found, run: run[SEEN] * found.ratio),
    "vehicle.x": _channel("distance", "m", "vehicle.x"), "vehicle.y": _channel("lateral position", "m", "vehicle.y"),
    "vehicle.speed": _channel("speed", "m/s", "vehicle.speed"), "vehicle.yaw_rate": _channel("yaw rate", "rad/s", "vehicle.yaw_rate"),
    "vehicle.ax": _channel("longitudinal acceleration", "m/s^2", "vehicle.ax"), "vehicle.ay": _channel("lateral acceleration", "m/s^2", "vehicle.ay"),
    "vehicle.az": _channel("vertical acceleration", "m/s^2", "vehicle.az"), "vehicle.sideslip": _channel("sideslip angle", "rad", "vehicle.sideslip"),
    "vehicle.roll": _channel("roll angle", "rad", "vehicle.roll"),
}  # fmt: skip
"""Quantities of charts by channel."""
RESPONSES = {"vehicle.yaw_rate": ("yaw rate", "rad/s/rad"), "vehicle.ay": ("lateral acceleration", "m/s^2/rad")}
"""Quantities of frequency responses by channel, with the SI unit of their gain."""


def handling_charts(variants: Mapping[str, Handling], name: str, display: DisplayUnits) -> list[str]:
    """Return the charts of a test; the runs of a variant have one colour."""
    runs = [(k, found, run) for k, found in enumerate(variants.values()) for run in found.tests[name].runs]
    if not runs:
        return []
    if name == "frequency_response":
        return list(_responses(variants, name, display))
    charts = [_course(runs, COURSES[name])] if name in COURSES else []
    for x, y in TESTS[name].shown:
        across, upwards = QUANTITIES[x], QUANTITIES[y]
        curves = [
            Curve("", _shown(across, found, run, display), _shown(upwards, found, run, display), f"c{k % 4}")
            for k, found, run in runs
        ]
        if name == RAMP:
            curves += [_tangent(curve) for curve in curves]
        charts.append(curve_chart(curves, upwards.title(display), across.title(display)))
    return charts


def _tangent(curve: Curve) -> Curve:
    """Return the tangent at zero lateral acceleration, whose slope is the gradient of the test."""
    value, slope = at_zero(curve.x, curve.y)
    x = np.array([0.0, curve.x[-1]])
    return Curve("", x, value + slope * x, "path")


def _shown(quantity: Quantity, found: Handling, run: Run, display: DisplayUnits) -> np.ndarray:
    return quantity.values(found, run) * display.of(quantity.unit)[1]


def _course(runs: Sequence[tuple[int, Handling, Run]], standard: str) -> str:
    """Return the paths of the reference point between the cones, with the path of the driver, in metres."""
    width, length = runs[0][1].width, runs[0][1].length
    lanes = tuple(lane.shifted(BEFORE) for lane in STANDARDS[standard](width))
    path = path_through(lanes, width, BEFORE, BEFORE, length)
    cones = np.array([(x, y) for lane in lanes for x in (lane.start, lane.end) for y in (lane.right, lane.left)])
    bounds = [
        Curve("", np.array([lane.start, lane.end]), np.full(2, y), "cones")
        for lane in lanes
        for y in (lane.right, lane.left)
    ]
    driven = [Curve("", run["vehicle.x"], run["vehicle.y"], f"c{k % 4}") for k, _, run in runs]
    title = "lateral position, m; dotted: path of the driver; triangles: cones"
    return curve_chart([*driven, Curve("", path[:, 0], path[:, 1], "path"), *bounds], title, "distance, m", marks=cones)


def _responses(variants: Mapping[str, Handling], name: str, display: DisplayUnits) -> Iterator[str]:
    """Yield gain and phase of the yaw rate and of the lateral acceleration over the frequencies of the sweep."""
    for channel, (quantity, unit) in RESPONSES.items():
        shown, factor = display.of(unit)
        gains, phases = [], []
        for k, found in enumerate(variants.values()):
            test = found.tests[name]
            if not test.runs:
                continue
            response = response_of_sweeps(found.ratio, test.runs, channel)
            band = (response.frequency >= test.parameters["first"]) & (response.frequency <= test.parameters["last"])
            gains.append(Curve("", response.frequency[band], response.gain[band] * factor, f"c{k % 4}"))
            phases.append(Curve("", response.frequency[band], np.degrees(response.phase[band]), f"c{k % 4}"))
        yield curve_chart(gains, f"{quantity} per steer angle, {written_unit(shown)}", "frequency, Hz")
        yield curve_chart(phases, f"phase of the {quantity}, deg", "frequency, Hz")
