"""Drawing the plot that a scene asks for (needs matplotlib, the extra ``plot``)."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..describe.figure import Figure
from ..errors import InputError
from ..results.files import refuse_path, written_whole
from ..results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

ENDINGS = (".png", ".svg", ".pdf")
SIZE = (8, 5)
TOTAL_ENERGY = Figure(title="total energy", y=("energy.total",))
LARGEST = 1e100
"""Beyond it matplotlib finds no ticks for an axis."""


def check_figure(path: Path) -> None:
    """Refuse, before anything is solved, a figure that could not be drawn.

    Raises
    ------
    InputError
        For an unknown ending, a missing folder, or a missing matplotlib.
    """
    refuse_path("--figure", path, ENDINGS)
    if find_spec("matplotlib") is None:
        raise InputError(f"--figure {path}: found no matplotlib, expected it installed: pip install 'stiffmbs[plot]'")


def draw(path: Path, solution: Solution, figure: Figure | None) -> None:
    """Draw a scene's own figure to a file; parameters and errors as for `drawn`."""
    sheet = drawn(solution, figure)
    written_whole(path, lambda part: sheet.savefig(part, dpi=120))


def drawn(solution: Solution, figure: Figure | None) -> Sheet:
    """A scene's own figure; without one, the total energy over time.

    Raises
    ------
    InputError
        When the figure names an unknown channel.
    """
    from matplotlib.figure import Figure as Sheet

    sheet = Sheet(figsize=SIZE, layout="constrained")
    draw_on(sheet, solution, figure or TOTAL_ENERGY)
    return sheet


def plotted(solution: Solution, figure: Figure | None) -> Sheet:
    """See `Solution.plot`."""
    if find_spec("matplotlib") is None:
        raise InputError("plot: found no matplotlib, expected it installed: pip install 'stiffmbs[plot]'")
    figure = figure or TOTAL_ENERGY
    for channel in (*figure.y, *([figure.x] if figure.x != "time" else []), *([figure.z] if figure.z else [])):
        solution[channel]  # refused before there is an empty figure
    from matplotlib import pyplot

    sheet = pyplot.figure(figsize=SIZE, layout="constrained")
    draw_on(sheet, solution, figure)
    return sheet


def _drawable(values: np.ndarray) -> np.ndarray:
    """Values without those of a diverged run that an axis cannot hold."""
    return np.where(np.abs(values) < LARGEST, values, np.nan)


def draw_on(sheet: Sheet, solution: Solution, figure: Figure) -> None:
    """Draw a figure on an empty sheet of matplotlib's; errors as for `drawn`."""
    x = solution.time if figure.x == "time" else solution[figure.x]
    units = {solution.unit(channel) for channel in figure.y}
    common = units if len(units) == 1 else set()
    axes: Any = sheet.add_subplot(projection="3d" if figure.z else None)
    for channel in figure.y:
        others = [solution[figure.z]] if figure.z else []
        label = channel if common else _label(solution, channel)
        axes.plot(*(_drawable(values) for values in (x, solution[channel], *others)), label=label)
    axes.set_xlabel(_label(solution, figure.x))
    if figure.z:
        axes.set_ylabel(_label(solution, figure.y[0]))
        axes.set_zlabel(_label(solution, figure.z))
    else:
        if common:
            axes.set_ylabel(common.pop())
        axes.legend()
    title = figure.title or solution.name
    axes.set_title(title, parse_math=_is_mathematical(title))
    if figure.equal:
        axes.set_aspect("equal")
    axes.grid(alpha=0.3)


def _label(solution: Solution, channel: str) -> str:
    """A channel with its unit, where it has one."""
    unit = solution.unit(channel)
    return f"{channel} ({unit})" if unit else channel


def _is_mathematical(title: str) -> bool:
    """Whether the formulas between dollar signs can be drawn as such; else they are shown as they are written."""
    from matplotlib.mathtext import MathTextParser

    try:
        MathTextParser("path").parse(title)
    except ValueError:
        return False
    return True
