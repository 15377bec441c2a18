"""Figures of pyplot that notebooks show once (imports matplotlib)."""

from __future__ import annotations

import matplotlib
from matplotlib import pyplot
from matplotlib.figure import Figure

INLINE = "inline"
"""Part of the name of the backend that shows all figures of a cell at its end."""


class ShownOnce(Figure):
    """Figure that a notebook shows either as the value of a cell or at its end."""

    def _ipython_display_(self) -> None:
        if INLINE in matplotlib.get_backend():
            pyplot.close(self)  # it is shown now, not again at the end of the cell
        elif pyplot.fignum_exists(getattr(self, "number", None) or 0):
            return  # it has a window
        raise NotImplementedError  # it is shown as any other figure
