"""Curves of a tyre as a table and as a figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..notes import note_lines
from ..studies.tyre_curves import CONSTANTS, TyreCurve
from .style import dress, legend_below, new_sheet, stroke

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

SIZE = (9, 7.5)


def tyre_figure(title: str, curves: Sequence[TyreCurve]) -> Sheet:
    """Draw Fx over slip, Fy and Mz over slip angle, and the friction ellipses."""
    sheet = new_sheet(SIZE)
    (along, across), (aligning, ellipse) = axes = sheet.subplots(2, 2)
    for k, curve in enumerate(curves):
        style: dict[str, object] = {**stroke(k), "label": _label(curve)}
        degrees = curve.alpha * 180 / math.pi
        along.plot(curve.kappa, curve.fx / 1e3, **style)
        style.pop("label")
        across.plot(degrees, curve.fy / 1e3, **style)
        aligning.plot(degrees, curve.mz, **style)
        ellipse.plot(curve.ellipse[1] / 1e3, curve.ellipse[0] / 1e3, **style)
    for one, x, y in (
        (along, "longitudinal slip", "Fx, kN"), (across, "slip angle, deg", "Fy, kN"),
        (aligning, "slip angle, deg", "Mz, N m"), (ellipse, "Fy, kN", "Fx, kN"),
    ):  # fmt: skip
        dress(one, xlabel=x, ylabel=y)
    ellipse.set_aspect("equal", adjustable="datalim")
    sheet.suptitle(title, parse_math=False)
    legend_below(sheet, axes.ravel())
    return sheet


def _label(curve: TyreCurve) -> str:
    return f"{curve.load:.4g} N" + ("" if curve.pressure is None else f", {curve.pressure / 1e3:.4g} kPa")


def tyre_text(title: str, curves: Sequence[TyreCurve], states: Sequence[dict[str, float]], notes: Sequence[str]) -> str:
    """Return a table of the constants at each load, of the peaks of the curves, and of single states."""
    rows: list[tuple[str, ...]] = [("load N", "pressure Pa", *CONSTANTS, "max Fx", "max |Fy|")]
    for curve in curves:
        peaks = float(curve.fx.max()), float(abs(curve.fy).max())
        rows.append((f"{curve.load:.6g}", "" if curve.pressure is None else f"{curve.pressure:.6g}",
                     *(f"{x:.5g}" for x in (*curve.constants.values(), *peaks))))  # fmt: skip
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [title, *("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)]
    lines += [", ".join(f"{name} {x + 0.0:.9g}" for name, x in state.items()) for state in states]
    return "\n".join([*lines, *note_lines(notes)])
