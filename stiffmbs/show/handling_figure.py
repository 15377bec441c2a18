"""Figures of handling tests: channels with their units; lane changes with cones and the path of the standard."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..model.paths.lanes import STANDARDS, path_through
from ..studies.handling.known import SEEN
from ..studies.handling.lane_changes import BEFORE, PART_1, PART_2
from ..studies.handling.standards import TESTS
from ..studies.handling.study import Handling, Tested
from .style import COLORS, dress, legend_below, new_sheet, stroke

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNITS = {"time": "s", "x": "m", "y": "m", "speed": "m/s", "yaw_rate": "rad/s", "ay": "m/s²", "az": "m/s²"}
NAMES = {"ay": "lateral acceleration", "az": "vertical acceleration", SEEN: "steering"}
COURSES = {"lane_change": PART_1, "obstacle_avoidance": PART_2}
"""Courses with cones, by test."""


def handling_figure(found: Handling, name: str, one: Tested) -> Figure:
    """Draw the runs of a test, with a legend where there are several lines."""
    sheet = new_sheet((7, 3.4))
    axes: Any = sheet.subplots()
    x, y = TESTS[name].shown
    for k, run in enumerate(one.runs):
        label = "vehicle" if len(one.runs) == 1 else f"run {k + 1}"
        axes.plot(run[x], run[y], **stroke(k), label=label)
    if name in COURSES:
        _course(axes, COURSES[name], found.width)
    dress(axes, xlabel=_label(x, found), ylabel=_label(y, found))
    if name in COURSES or len(one.runs) > 1:
        legend_below(sheet, [axes])
    return sheet


def _course(axes: Axes, standard: str, width: float) -> None:
    """Draw the cones at the boundaries of the lanes, and the path of the driver, for the width of the vehicle, m."""
    lanes = tuple(lane.shifted(BEFORE) for lane in STANDARDS[standard](width))
    path = path_through(lanes, width, BEFORE, BEFORE)
    axes.plot(path[:, 0], path[:, 1], color="0.5", linestyle=":", label="path")
    cones = [(x, y) for lane in lanes for x in (lane.start, lane.end) for y in (lane.right, lane.left)]
    axes.plot(*zip(*cones, strict=True), "^", color=COLORS[1], markersize=5, label="cones")
    for lane in lanes:
        for y in (lane.right, lane.left):
            axes.plot((lane.start, lane.end), (y, y), color=COLORS[1], linewidth=0.5)


def _label(channel: str, found: Handling) -> str:
    """Return a channel in words with its unit."""
    last = channel.rpartition(".")[2]
    unit = ("rad" if found.car.angular else "m") if channel == SEEN else UNITS.get(last, "")
    words = NAMES.get(last, last.replace("_", " "))
    return f"{words} ({unit})" if unit else words
