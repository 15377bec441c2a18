"""Colors and strokes that distinguish the lines of plots, for colour-blind readers and in grey."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ..results.files import written_whole
from .origin import figure_metadata

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet

    from ..results.provenance import Provenance

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
"""Colors of Okabe and Ito, Color Universal Design (2008)."""
STROKES: tuple[object, ...] = ("-", "--", "-.", ":", (0, (8, 2)), (0, (5, 1, 1, 1, 1, 1)))


def new_sheet(size: tuple[float, float], on_screen: bool = False) -> Sheet:
    """Return an empty figure of matplotlib, size in inches; on screen, one of pyplot."""
    if on_screen:
        from matplotlib import pyplot

        from .shown_once import ShownOnce

        return pyplot.figure(figsize=size, layout="constrained", FigureClass=ShownOnce)
    from matplotlib.figure import Figure as Sheet

    return Sheet(figsize=size, layout="constrained")


def write_sheet(path: Path, sheet: Sheet, dpi: int = 120, origin: Provenance | None = None) -> None:
    """Write a figure to a file, completely or not at all, with the origin of its results in its metadata.

    Raises OSError if the file cannot be written.
    """
    metadata = figure_metadata(path, origin)
    written_whole(path, lambda part: sheet.savefig(part, dpi=dpi, metadata=metadata))


def data_url(sheet: Sheet, form: str, dpi: int) -> str:
    """Return a figure as a data URL: ``svg`` or ``png``."""
    content = io.BytesIO()
    sheet.savefig(content, format=form, dpi=dpi, metadata={"Date": None} if form == "svg" else None)
    kind = {"svg": "image/svg+xml", "png": "image/png"}[form]
    return f"data:{kind};base64,{base64.b64encode(content.getvalue()).decode('ascii')}"


def stroke(k: int, dashes: int | None = None) -> dict[str, object]:
    """Return color and stroke of the k-th line of a plot; they repeat together after 42 lines. `dashes`: number of its stroke, by default k."""
    line = STROKES[(k if dashes is None else dashes) % len(STROKES)]
    return {"color": COLORS[k % len(COLORS)], "linestyle": line, "linewidth": 1.4}


def dress(axes: Axes, **labels: str) -> None:
    """Set `xlabel`, `ylabel` or `title`, add a light grid, and remove the frame above and to the right."""
    axes.set(**labels)
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)


def legend_below(sheet: Sheet, axes: Iterable[Axes]) -> None:
    """Add the legend of all lines below the plots, where it hides nothing."""
    handles, labels = [], []
    for one in axes:
        found = one.get_legend_handles_labels()
        handles += found[0]
        labels += found[1]
    if handles:
        sheet.legend(handles, labels, loc="outside lower center", ncols=min(3, len(handles)), frameon=False)
