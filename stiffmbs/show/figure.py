"""Drawing the plot that a scene asks for (needs matplotlib, the extra ``plot``)."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from ..describe.figure import Figure
from ..errors import InputError
from .files import refuse_path
from .solution import Solution

ENDINGS = (".png", ".svg", ".pdf")


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
    """Draw a scene's own figure; without one, the total energy over time.

    Raises
    ------
    InputError
        When the figure names an unknown channel.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    chosen = figure or Figure(title="total energy", y=("energy.total",))
    x = solution.time if chosen.x == "time" else solution[chosen.x]
    sheet, axes = pyplot.subplots(figsize=(8, 5), layout="constrained")
    for channel in chosen.y:
        axes.plot(x, solution[channel], label=channel)
    axes.set_xlabel("time (s)" if chosen.x == "time" else chosen.x)
    axes.set_title(chosen.title or solution.name)
    if chosen.equal:
        axes.set_aspect("equal")
    axes.grid(alpha=0.3)
    axes.legend()
    sheet.savefig(path, dpi=120)
    pyplot.close(sheet)
