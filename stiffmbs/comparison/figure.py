"""Figures of comparisons (need matplotlib, the extra ``plot``)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..show.style import dress, legend_below, new_sheet, stroke, write_sheet
from .compare import Comparison
from .comparison_over import ComparisonOver, logarithmic
from .measures import MEASURES

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

    from ..results.provenance import Provenance


def write_figure(path: Path, sheet: Sheet, origin: Provenance | None = None) -> None:
    """Write a figure with the origin of its results; text in .svg stays text."""
    from matplotlib import rc_context

    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "stiffmbs"}):
        write_sheet(path, sheet, origin=origin)


def work_precision(comparison: Comparison) -> Sheet:
    """Plot time against error of each solver, both logarithmic."""
    axes: Any = new_sheet((7, 4.2)).add_subplot()
    measure, resolved = comparison.measure, comparison.reference.resolved(comparison.measure)
    for name in dict.fromkeys(row.solver for row in comparison.rows):
        own = [row for row in comparison.rows if row.solver == name and row.errors]
        known = [row for row in own if np.isfinite(row.errors[measure]) and row.errors[measure] > resolved]
        if known:
            curve(axes, [row.errors[measure] for row in known], [row.seconds for row in known], name)
    axes.invert_xaxis()
    finished(axes, f"largest error in {measure}, {MEASURES[measure].unit}", comparison.name)
    return axes.figure


def over_parameter(comparison: ComparisonOver) -> Sheet:
    """Plot the time of each solver against the parameter, with the crossings."""
    axes: Any = new_sheet((7, 4.2)).add_subplot()
    for entry in comparison.entries:
        pairs = [
            (one.value, one.at.seconds[entry.name])
            for one in comparison.values
            if one.at and entry.name in one.at.seconds
        ]
        if pairs:
            values, seconds = zip(*pairs, strict=True)
            curve(axes, values, seconds, entry.name)
    for crossing in comparison.crossings:
        axes.axvline(
            crossing.at, color="0.5", linestyle=":", label=f"{crossing.then} is faster from {crossing.at:.1e} on"
        )
    if not logarithmic([one.value for one in comparison.values]):
        axes.set_xscale("linear")
    error = f"{comparison.error:g} {MEASURES[comparison.measure].unit}"
    finished(axes, comparison.parameter, f"{comparison.name} at an error of {error}")
    return axes.figure


def curve(axes: Any, x: Sequence[float], seconds: Sequence[float], label: str, marker: str = ".") -> None:
    """Plot the times of a solver on logarithmic axes; lines differ in color and in stroke."""
    axes.loglog(x, seconds, marker=marker, label=label, **stroke(len(axes.lines)))


def finished(axes: Any, x: str, title: str) -> None:
    """Add labels, grid and legend to the axes."""
    dress(axes, xlabel=x, ylabel="time of a solution, s", title=title)
    legend_below(axes.figure, [axes])
