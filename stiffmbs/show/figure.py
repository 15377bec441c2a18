"""Plots of runs, as defined by scenes or in a window (needs matplotlib, the extra ``plot``)."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, refuse_missing
from ..model.scene import Figure
from ..reading.units.quantity import LARGEST
from ..results.displayed import displayed
from ..results.files import refuse_path
from ..results.solution import Solution
from .style import dress, legend_below, new_sheet, stroke

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


SIZE = (8, 5)
TOTAL_ENERGY = Figure(title="total energy", y=("energy.total",))
MOST_PLOTS = 6
"""Number of units above which all lines share one plot, with the units in the legend."""


def drawn(solution: Solution, figure: Figure | None) -> Sheet:
    """Draw a scene's own figure, or the total energy over time if it has none.

    InputError if the figure names an unknown channel.
    """
    sheet = new_sheet(SIZE)
    draw_runs(sheet, {"": solution}, figure or TOTAL_ENERGY)
    return sheet


def plot(
    solution: Solution, *channels: str, x: str = "time", z: str = "", title: str = "", equal: bool = False
) -> Sheet:
    """Plot channels over time, or over another channel (needs matplotlib, the extra ``plot``).

    Parameters
    ----------
    solution : Solution
    *channels : str
        Names of channels; a plot for each unit.  Without any, the figure that the scene describes, or the total energy.
    x : str
        A channel, or ``"time"``.
    z : str
        A channel: the figure is then a path in space, of one channel over `x`.
    title : str
        Title of the figure; the scene's name by default.
    equal : bool
        True for the same scale on all axes, as for paths.

    Returns
    -------
    matplotlib.figure.Figure
        Figure of pyplot, which ``pyplot.show()`` displays.

    Raises
    ------
    InputError
        If there is no such channel, or matplotlib is not installed.
    """
    refuse_missing("matplotlib", "'stiffmbs[plot]'", "plot: ")
    figure = figure_of({"": solution}, channels, x, title, z, equal)
    sheet = new_sheet(SIZE, on_screen=True)
    draw_runs(sheet, {"": solution}, figure)
    return sheet


def figure_of(
    runs: Mapping[str, Solution],
    channels: Sequence[str],
    against: str,
    title: str = "",
    z: str = "",
    equal: bool = False,
) -> Figure:
    """Return the figure to draw: the given channels, by default the scene's own figure or the total energy.

    Raises InputError if a run has no such channel.
    """
    if channels:
        figure = Figure(y=tuple(channels), x=against, z=z, title=title, equal=equal)
    else:
        figure = next(iter(runs.values())).figure or TOTAL_ENERGY
    for run in runs.values():
        for channel in (*figure.y, figure.x, figure.z):
            if channel not in ("time", ""):
                run[channel]
    return figure


def draw_runs(sheet: Sheet, runs: Mapping[str, Solution], figure: Figure) -> None:
    """Draw the same channels of several runs in the display units of the first, with one plot for each unit and a legend below.

    Of several channels each has a color, which its lines of all runs share; each line has its own stroke.
    `sheet`: empty sheet. `runs`: runs by their names in the legend; a single run may have no name. Raises InputError if
    a run has no such channel.
    """
    first = next(iter(runs.values()))
    runs = {name: displayed(run, first) for name, run in runs.items()}
    first = next(iter(runs.values()))
    units = [""] if figure.z else list(dict.fromkeys(first.unit(channel) for channel in figure.y))
    count = len(units) if len(units) <= MOST_PLOTS else 1
    plots: Any = sheet.subplots(count, sharex=True, squeeze=False, subplot_kw={"projection": "3d"} if figure.z else {})[
        :, 0
    ]
    of_both = len(figure.y) > 1 and len(runs) > 1
    lines = [(k, channel, name) for k, channel in enumerate(figure.y) for name in runs]
    for number, (k, channel, name) in enumerate(lines):
        style = stroke(k if of_both else number, number)
        unit = first.unit(channel)
        axes = plots[units.index(unit) if count > 1 else 0]
        run, label = runs[name], channel if count > 1 or len(units) == 1 else _label(first, channel)
        others = [run[figure.z]] if figure.z else []
        x = run.time if figure.x == "time" else run[figure.x]
        values = (
            np.where(np.abs(part) < LARGEST, part, np.nan) for part in (x, run[channel], *others)
        )  # a run may diverge
        axes.plot(*values, label=f"{label}, {name}" if name else label, **style)
    _name_axes(plots, first, figure, units if count > 1 or len(units) == 1 else [""])
    title = figure.title or first.name
    plots[0].set_title(title, parse_math=_is_mathematical(title))
    legend_below(sheet, plots)


def _name_axes(plots: Any, solution: Solution, figure: Figure, units: Sequence[str]) -> None:
    for axes, unit in zip(plots, units, strict=True):
        if figure.z:
            axes.set_ylabel(_label(solution, figure.y[0]))
            axes.set_zlabel(_label(solution, figure.z))
            axes.grid(alpha=0.3)
        else:
            of_unit = [channel for channel in figure.y if solution.unit(channel) == unit]
            axes.set_ylabel(_label(solution, of_unit[0]) if len(of_unit) == 1 else unit)
            dress(axes)
        if figure.equal:
            axes.set_aspect("equal")
    plots[-1].set_xlabel(_label(solution, figure.x))


def _label(solution: Solution, channel: str) -> str:
    """Return a channel with its unit, if any."""
    unit = solution.unit(channel)
    return f"{channel} ({unit})" if unit else channel


def _is_mathematical(title: str) -> bool:
    """Return True if the formulas between dollar signs are valid; otherwise they are shown as text."""
    from matplotlib.mathtext import MathTextParser

    try:
        MathTextParser("path").parse(title)
    except ValueError:
        return False
    return True


def check_plot(path: Path | None) -> None:
    """Check that a plot can be drawn to a file, or in a window without a path, before anything is solved."""
    if path is not None:
        refuse_path("-o", path, "figure")
        return
    refuse_missing("matplotlib", "'stiffmbs[plot]'", "plot: ")
    has_screen = sys.platform in ("darwin", "win32") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not has_screen:
        raise InputError("plot: found no screen for a window, expected -o FILE, such as -o plot.svg")


def plotted_runs(runs: Mapping[str, Solution], figure: Figure, in_window: bool = False) -> Sheet:
    """Return the plots on a sheet; in a window, a figure of pyplot.

    `runs`: runs by their names in the legend; a single run may have no name.
    """
    first = next(iter(runs.values()))
    plots = 1 if figure.z else len({first.unit(channel) for channel in figure.y})
    sheet = new_sheet((8.0, max(5.0, 3.4 * min(plots, 4))), in_window)
    draw_runs(sheet, runs, figure)
    return sheet


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
