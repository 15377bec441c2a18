"""Plots of any channels of one run or several, also during a run (needs matplotlib, the extra ``plot``)."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError, refuse_missing
from ..model.scene import Figure
from ..results.files import refuse_path, written_whole
from ..results.solution import Solution
from .figure import ENDINGS, draw_runs, figure_of
from .style import new_sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


def check_plot(path: Path | None) -> None:
    """Check that a plot can be drawn to a file, or in a window without a path, before anything is solved."""
    if path is not None:
        refuse_path("-o", path, ENDINGS)
    refuse_missing("matplotlib", "'stiffmbs[plot]'", "plot: ")
    if path is None and not _has_screen():
        raise InputError("plot: found no screen for a window, expected -o FILE, such as -o plot.svg")


def _has_screen() -> bool:
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def plotted_runs(runs: Mapping[str, Solution], figure: Figure, in_window: bool = False) -> Sheet:
    """Return the plots on a sheet; in a window, a figure of pyplot.

    `runs`: runs by their names in the legend; a single run may have no name.
    """
    first = next(iter(runs.values()))
    plots = 1 if figure.z else len({first.unit(channel) for channel in figure.y})
    sheet = new_sheet((8.0, max(5.0, 3.4 * min(plots, 4))), in_window)
    draw_runs(sheet, runs, figure)
    return sheet


def write_plot(path: Path, sheet: Sheet) -> None:
    """Write a sheet to a file, completely or not at all."""
    written_whole(path, lambda part: sheet.savefig(part, dpi=130))


def show_live(solutions: Iterator[Solution], channels: Sequence[str], against: str, title: str = "") -> Figure:
    """Draw each of the solutions as it arrives, in one window, until the last one or until the window is closed.

    `solutions`: solutions as `stiffmbs.follow` yields them. `channels`: channels; by default the scene's own figure.
    `against`: a channel, or time. The result: figure that was drawn. Raises InputError if a run has no such channel.
    """
    from matplotlib import pyplot

    first = next(solutions)
    figure = figure_of({"": first}, channels, against, title)
    sheet = plotted_runs({"": first}, figure, in_window=True)
    pyplot.show(block=False)
    _refresh(sheet)
    for solution in solutions:
        if not pyplot.fignum_exists(sheet.number):
            break
        sheet.clear()
        draw_runs(sheet, {"": solution}, figure)
        _refresh(sheet)
    return figure


def _refresh(sheet: Sheet) -> None:
    """Redraw, and process window events."""
    sheet.canvas.draw_idle()
    sheet.canvas.flush_events()
