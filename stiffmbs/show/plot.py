"""Plots of any channels of one run or several (needs matplotlib, the extra ``plot``)."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ..describe.figure import Figure
from ..errors import InputError
from ..results.files import refuse_path, written_whole
from ..results.solution import Solution
from .figure import ENDINGS, draw_runs

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

WIDTH, HEIGHT = 8.0, 3.4
"""Size of a plot, inch."""


def check_plot(path: Path | None) -> None:
    """Check that a plot can be drawn to a file, or in a window without a path, before anything is solved.

    Raises
    ------
    InputError
    """
    if path is not None:
        refuse_path("-o", path, ENDINGS)
    if find_spec("matplotlib") is None:
        raise InputError("plot: found no matplotlib, expected it installed: pip install 'stiffmbs[plot]'")
    if path is None and not _has_screen():
        raise InputError("plot: found no screen for a window, expected -o FILE, such as -o plot.svg")


def _has_screen() -> bool:
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def figure_of(runs: Mapping[str, Solution], channels: Sequence[str], against: str, title: str = "") -> Figure:
    """Return the figure to draw: the given channels, by default the scene's own figure or the total energy.

    Raises
    ------
    InputError
        If a run has no such channel.
    """
    first = next(iter(runs.values()))
    if channels:
        figure = Figure(y=tuple(channels), x=against, title=title)
    else:
        figure = first.figure or Figure(title="total energy", y=("energy.total",))
    for run in runs.values():
        for channel in (*figure.y, figure.x, figure.z):
            if channel not in ("time", ""):
                run[channel]
    return figure


def plotted_runs(runs: Mapping[str, Solution], figure: Figure, in_window: bool = False) -> Sheet:
    """Return the plots on a sheet; in a window, a figure of pyplot.

    Parameters
    ----------
    runs : mapping of str to Solution
        Runs by their names in the legend; a single run may have no name.
    figure : Figure
    in_window : bool
    """
    first = next(iter(runs.values()))
    plots = 1 if figure.z else len({first.unit(channel) for channel in figure.y})
    size = (WIDTH, max(5.0, HEIGHT * min(plots, 4)))
    if in_window:
        from matplotlib import pyplot

        sheet = pyplot.figure(figsize=size, layout="constrained")
    else:
        from matplotlib.figure import Figure as Sheet

        sheet = Sheet(figsize=size, layout="constrained")
    draw_runs(sheet, runs, figure)
    return sheet


def write_plot(path: Path, sheet: Sheet) -> None:
    """Write a sheet to a file, completely or not at all."""
    written_whole(path, lambda part: sheet.savefig(part, dpi=130))


def show_window() -> None:
    """Show the window until it is closed."""
    from matplotlib import pyplot

    pyplot.show()
