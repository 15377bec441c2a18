"""Tables of the ranges of forces and torques, with as many digits as their error bars allow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..compile.bodies import SPACE
from ..evaluation.loads import elements_of, reactions_of
from ..evaluation.parameters import EVALUATION
from ..results.error_bars import ErrorBar
from ..results.solution import Solution, channel_ranges

if TYPE_CHECKING:
    from rich.table import Table


PLENTY = 9
"""Most significant digits of a number."""
LEAST_WITHOUT_EXPONENT = 1e-3
"""Least number that is written without an exponent."""


def with_bar(value: float, half: float, noise: float = 0.0) -> str:
    """Return a value and the half width of its error bar, nan if unknown, as ``12.345 ± 0.002``.

    The bar has one digit, rounded up, or two if the first would be 1; the last digit of the value is at the same place.
    `noise`: size up to which values and bars are zero.

    Examples
    --------
    >>> with_bar(12.34567, 0.0018)
    '12.3457 ± 0.0018'
    >>> with_bar(12.34567, 0.0071)
    '12.346 ± 0.008'
    >>> with_bar(123456.7, 430.0)
    '123500 ± 500'
    >>> with_bar(12.34567, float("nan"))
    '12.346 (not known how well)'
    """
    if math.isnan(half):
        return f"{value:.5g} (not known how well)"
    if abs(value) <= noise and half <= noise:
        return "0"
    if not math.isfinite(half) or not math.isfinite(value):
        return f"{value:.5g} ± {half:.1g}"
    digit = math.floor(math.log10(half)) if half > 0 else -300
    if half > 0 and half / 10.0**digit <= 1.95:
        digit -= 1
    digit = max(digit, math.floor(math.log10(max(abs(value), half))) + 1 - PLENTY)
    step = 10.0**digit
    known, bar = round(value / step) * step, math.ceil(half / step * (1 - 1e-9)) * step
    if digit >= 0:
        large = max(abs(known), bar) >= 10.0 ** (PLENTY + 1)
        return f"{known:.3e} ± {bar:.0e}" if large else f"{known:.0f} ± {bar:.0f}"
    if max(abs(known), bar) >= LEAST_WITHOUT_EXPONENT:
        return f"{known:.{-digit}f} ± {bar:.{-digit}f}"
    places = max(math.floor(math.log10(abs(known))) - digit, 0) if known else 0
    return f"{known:.{places}e} ± {bar:.0e}"


NOT_UNIQUE = "*"
"""Mark of the range of a reaction without a unique value."""
Cell = Mapping[str, float]


@dataclass(frozen=True)
class Loads:
    """Choice of the loads of a summary."""

    most: int = 10  # number of elements that are listed by default, those of the largest loads


LOADS = Loads()


def rich_table(heads: Sequence[str], *rows: Sequence[str]) -> Table:
    """Return rows as a table for a console of rich."""
    from rich.table import Table

    table = Table()
    for k, head in enumerate(heads):
        table.add_column(head, justify="right" if k else "left", no_wrap=k == 0, overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def force_rows(solution: Solution, most: int | None = None) -> list[list[str]]:
    """Return the heads, and a row for each element; in space one for its force, and one for its torque if it has any.

    `most`: number of elements, those of the largest loads in the order of the scene; all by default.
    """
    ranges = channel_ranges(solution)
    components = reactions_of(solution)
    in_space = components == SPACE.reactions
    every = elements_of(solution)
    loads = {element: tuple(_largest(ranges[f"{element}.{part}"]) for part in components) for element in every}
    noise = EVALUATION.zero * max((max(load) for load in loads.values()), default=0.0)
    n_forces = 3 if in_space else 2
    by_load = sorted(every, key=lambda element: (max(loads[element][:n_forces]), max(loads[element])), reverse=True)
    shown = set(by_load[:most])
    elements = [element for element in every if element in shown]

    def cells(element: str, components: Sequence[str]) -> list[str]:
        """Return the cells of an element."""
        names = [f"{element}.{part}" for part in components]
        marks = [NOT_UNIQUE * (name in solution.not_unique) for name in names]
        return [
            _range(ranges[name], solution.errors.get(name), noise) + mark
            for name, mark in zip(names, marks, strict=True)
        ]

    def acts(element: str, components: Sequence[str]) -> bool:
        names = [f"{element}.{component}" for component in components]
        return any(_largest(ranges[name]) > noise or name in solution.not_unique for name in names)

    rows = [["element", *(("x", "y", "z") if in_space else components)]]
    for element in elements:
        if not in_space:
            rows.append([element, *cells(element, components)])
            continue
        rows.append([element, *cells(element, components[:3])])
        if acts(element, components[3:]):
            rows.append(["  torque", *cells(element, components[3:])])
    return rows


def request_lines(solution: Solution, most: int | None = None) -> list[str]:
    """Return a line for each request, with its range and unit; `most`: number of requests, all by default."""
    ranges, names = channel_ranges(solution), list(solution.requested)
    lines = [
        f"{name}: {_range(ranges[name], solution.errors.get(name), 0.0).replace(chr(10), ' .. ')} {solution.unit(name)}".rstrip()
        for name in names[:most]
    ]
    left = len(names) - len(lines)
    return [*lines, *([f"and {left} more (--all shows all)"] if left else [])]


def _largest(cell: Cell) -> float:
    return max(abs(cell["min"]), abs(cell["max"]))


def _range(cell: Cell, bar: ErrorBar | None, noise: float) -> str:
    """Return the least and greatest value; for a verified run, each on a line with its error bar."""
    ends = (cell["min"], cell["max"])
    if bar is None:
        return " .. ".join("0" if abs(end) <= noise else f"{end:.5g}" for end in ends)
    return "\n".join(with_bar(end, half, noise) for end, half in zip(ends, (bar.least, bar.greatest), strict=True))
