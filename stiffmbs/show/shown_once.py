"""Figures of pyplot that notebooks show once (imports matplotlib)."""

from __future__ import annotations

from matplotlib import pyplot
from matplotlib.figure import Figure


class ShownOnce(Figure):
    """Figure that a notebook does not show as the value of a cell if pyplot shows it at the end of the cell."""

    def _ipython_display_(self) -> None:
        if self not in map(pyplot.figure, pyplot.get_fignums()):
            raise NotImplementedError  # it is shown as any other figure
