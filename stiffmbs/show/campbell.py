"""Modes over a parameter as text, as columns and as a figure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..analyses.linearised.campbell import Branch, Campbell, Crossing
from ..analyses.linearised.modes import ON_A_SCREEN
from ..analyses.linearised.modes_table import bodies_of
from ..analyses.settled import GROWING
from ..notes import note_lines
from .style import COLORS, dress, legend_below, new_sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

SIZE = (8, 8)
PLANE = 0.1
"""Whirl below which a mode is one in a plane."""
BEYOND = 1.2
"""Highest frequency shown, relative to the end of the steepest line of an order, or to the highest mode that is printed."""
DIRECTIONS = {"forward": COLORS[0], "backward": COLORS[1], "": COLORS[2]}
"""Color of each direction of whirl."""


def direction(whirl: float) -> str:
    """Return the direction of whirl: ``forward``, ``backward``, or empty."""
    return "forward" if whirl > PLANE else "backward" if whirl < -PLANE else ""


def campbell_text(found: Campbell, orders: Sequence[float] | None = None) -> str:
    """Return a table of the branches at both ends, the critical speeds and the limits of stability."""
    low, high = found.values[[0, -1]]
    unit = f" {found.unit}" if found.unit else ""
    lines = [
        f"{found.name or 'model'}: {len(found.branches)} modes over {found.parameter} from {low:g}{unit} to {high:g}{unit}, {len(found.values)} values",
        f"{'':>4}  {f'Hz at {low:g}':>14}  {f'Hz at {high:g}':>14}  {'least damping':>14}  {'whirl':<9}  kinetic energy",
    ]
    for k, branch in enumerate(found.branches[:ON_A_SCREEN], start=1):
        ends = (_shown(value) for value in branch.frequencies[[0, -1]])
        way = direction(float(np.nanmedian(branch.whirl))) if not np.isnan(branch.whirl).all() else ""
        lines.append(
            f"{k:>4}  {next(ends):>14}  {next(ends):>14}  {_least(branch, found):>14}  {way:<9}  {bodies_of(branch.participation)}".rstrip()
        )
    if len(found.branches) > ON_A_SCREEN:
        lines.append(f"and {len(found.branches) - ON_A_SCREEN} more modes")
    for order in found.orders(orders):
        lines += _listed(f"critical speeds, order {order:g}", found.critical(order), unit)
    for growing, words in ((True, "stable below"), (False, "stable above")):
        lines += _listed(words, [each for each in found.limits() if each.growing == growing], unit)
    return "\n".join([*lines, *note_lines(found.notes)])


def _listed(title: str, crossings: Sequence[Crossing], unit: str) -> Iterator[str]:
    """Yield a title and a line for each crossing; nothing without crossings."""
    if crossings:
        yield f"{title}:"
    for each in crossings:
        way = direction(each.whirl)
        yield f"  {each.value:.6g}{unit}  mode {each.branch}, {each.frequency:.6g} Hz{f', {way} whirl' if way else ''}"


def _shown(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.6g}"


def _least(branch: Branch, found: Campbell) -> str:
    """Return the least damping ratio, or ``unstable`` if a motion without oscillation grows."""
    known = branch.damping_ratios[~np.isnan(branch.damping_ratios)]
    if np.any((branch.growth > found.rounding(np.abs(branch.growth))) & (branch.frequencies == 0.0)):
        return "unstable"
    return (f"{known.min():.4g}" if abs(known.min()) > GROWING else "0") if len(known) else "-"


def campbell_csv(found: Campbell) -> str:
    """Return frequency, damping ratio and whirl of each branch over the parameter as CSV."""
    kinds = ("frequency [Hz]", "damping ratio", "whirl")
    names = [f"mode {k} {kind}" for k in range(1, len(found.branches) + 1) for kind in kinds]
    columns = [part for branch in found.branches for part in (branch.frequencies, branch.damping_ratios, branch.whirl)]
    head = f"{found.parameter} [{found.unit}]" if found.unit else found.parameter
    rows = [",".join([head, *names])]
    rows += [
        ",".join("" if np.isnan(number) else f"{number:.15g}" for number in row)
        for row in np.column_stack([found.values, *columns])
    ]
    return "\n".join(rows) + "\n"


def campbell_figure(found: Campbell, orders: Sequence[float] | None = None, highest: float | None = None) -> Sheet:
    """Draw frequencies and damping ratios over the parameter; parameters as for `Campbell.plot`."""
    sheet = new_sheet(SIZE)
    above, below = sheet.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    slopes = {order: order / (2 * np.pi) for order in found.orders(orders)}
    last = float(np.max(np.abs(found.values)))
    top = highest or _highest(found, max(slopes.values(), default=0.0) * last)
    names: set[str] = set()
    for branch in _below(found, top):
        for way, color in DIRECTIONS.items():
            here = np.array([direction(value) == way for value in branch.whirl])
            if not here.any():
                continue
            here[:-1] |= here[1:]  # up to the value at which the direction changes
            name = f"{way} whirl" if way else "" if np.isnan(branch.whirl).all() else "other modes"
            above.plot(
                found.values,
                np.where(here, branch.frequencies, np.nan),
                color=color,
                label=name if name not in names else None,
            )
            below.plot(found.values, np.where(here, branch.damping_ratios, np.nan), color=color)
            names.add(name)
    for order, slope in slopes.items():
        for side in {-1.0, 1.0} & set(np.sign(found.values)):
            end = min(float(np.max(side * found.values)), top / slope)
            above.plot([0.0, side * end], [0.0, slope * end], color="0.4", linestyle="--")
            place = "right" if side > 0.0 else "left"
            above.annotate(
                f"{order:g}x",
                (side * end, slope * end),
                (-3 * side, 3),
                textcoords="offset points",
                color="0.4",
                ha=place,
            )
        critical = found.critical(order)
        above.plot(
            [each.value for each in critical], [each.frequency for each in critical], "o", color="0.2", markersize=5
        )
    unit = f", {found.unit}" if found.unit else ""
    dress(above, ylabel="frequency, Hz")
    above.set_ylim(0.0, top)
    dress(below, xlabel=f"{found.parameter}{unit}", ylabel="damping ratio")
    below.axhline(0.0, color="0.4", linewidth=0.8)
    if np.ptp(below.get_ylim()) < GROWING:  # rounding
        below.set_ylim(-1.0, 1.0)
    sheet.suptitle(found.name or "model", parse_math=False)
    legend_below(sheet, [above])
    return sheet


def _below(found: Campbell, highest: float) -> list[Branch]:
    """Return the branches that oscillate below a frequency, Hz."""
    least = [np.nanmin(branch.frequencies, initial=np.inf) for branch in found.branches]
    most = [np.nanmax(branch.frequencies, initial=0.0) for branch in found.branches]
    return [
        branch for branch, low, high in zip(found.branches, least, most, strict=True) if high > 0.0 and low <= highest
    ]


def _highest(found: Campbell, line: float) -> float:
    """Return the highest frequency shown, Hz: above the steepest line of an order, or with a number of modes."""
    if line > 0.0:
        return BEYOND * line
    most = sorted(float(np.nanmax(branch.frequencies, initial=0.0)) for branch in found.branches)
    oscillating = [value for value in most if value > 0.0]
    return BEYOND * oscillating[min(len(oscillating), ON_A_SCREEN) - 1] if oscillating else 1.0
