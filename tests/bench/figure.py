"""Work-precision figures: run time over error, both logarithmic."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stiffmbs.comparison.figure import curve, finished
from stiffmbs.comparison.machine import machine_sentence

from .benchmark import Row
from .sweep import at_target_rows

SIZE = (8, 5.5)
"""Of figures, inches, with a line on the machine."""


def draw(problem: str, rows: Sequence[Row], folder: Path) -> Path:
    """Draw the rows of a problem; peers have crosses.

    Returns
    -------
    Path
        Of the figure, ``PROBLEM.svg`` in the folder, which is made if need be.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    draw_rows(figure.add_subplot(), problem, rows)
    figure.supxlabel(machine_sentence(), fontsize=5)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{problem}.svg"
    figure.savefig(path)
    return path


def draw_rows(axes: Any, problem: str, rows: Sequence[Row]) -> None:
    """Draw the rows of a problem on empty axes of matplotlib's."""
    measured = [row for row in rows if row.error > 0 and row not in at_target_rows(rows)]
    for solver in dict.fromkeys(row.solver for row in measured):
        own = sorted((r for r in measured if r.solver == solver), key=lambda r: r.seconds)
        marker = "x" if own[0].peer else "."
        curve(axes, [r.error for r in own], [r.seconds for r in own], solver, marker)
    axes.invert_xaxis()
    finished(axes, "largest error, m or rad", problem)
