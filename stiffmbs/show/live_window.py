"""Window with plots that are updated during a run (needs matplotlib, the extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..describe.figure import Figure
from ..results.solution import Solution
from .figure import draw_runs
from .plot import figure_of, plotted_runs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure as Sheet


def show_live(solutions: Iterator[Solution], channels: Sequence[str], against: str, title: str = "") -> Figure:
    """Draw each of the solutions as it arrives, in one window, until the last one or until the window is closed.

    Parameters
    ----------
    solutions : iterator of Solution
        Solutions as `stiffmbs.follow` yields them.
    channels : sequence of str
        Channels; by default the scene's own figure.
    against : str
        A channel, or time.
    title : str

    Returns
    -------
    Figure
        Figure that was drawn.

    Raises
    ------
    InputError
        If a run has no such channel.
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
