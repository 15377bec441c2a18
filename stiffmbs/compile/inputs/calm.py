"""Times without features of inputs, for all values of a parameter within bounds."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...reading.formula.nodes import TIME, reading_order
from .features import PIECES_OF_A_STEP, aside, conditions
from .interval_arithmetic import Enclosure
from .of_time import evaluated_at, evaluated_within
from .pieces import longest_pieces
from .table_ranges import TableRanges


@dataclass(frozen=True)
class RangedInput:
    """Expression of time whose constants may have any values within bounds.

    `lower`, `upper`: values by name, with the parameter at either of its bounds; they are affine functions of it.
    `of_joint`: true, so that the bends of its tables count as breakpoints.
    """

    tree: ast.expr
    lower: Mapping[str, float]
    upper: Mapping[str, float]
    tables: Mapping[str, TableRanges]
    of_joint: bool = True

    def at(self, part: float) -> RangedInput:
        """Return the expression with the parameter at a part of the way between its bounds."""
        values = {name: value + part * (self.upper[name] - value) for name, value in self.lower.items()}
        return replace(self, lower=values, upper=values)

    def within(self, low: np.ndarray, high: np.ndarray, order: int = 1, part: ast.expr | None = None) -> Enclosure:
        """Return ranges of the values and Taylor coefficients over time intervals."""
        values = {
            name: value if value == self.upper[name] else _between(value, self.upper[name], len(low), order)
            for name, value in self.lower.items()
        }
        return evaluated_within(part or self.tree, low, high, order, values, self.tables)

    def longest(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return the longest parts of intervals that a cubic represents; zero where that is unknown."""
        middle = {name: (value + self.upper[name]) / 2.0 for name, value in self.lower.items()}
        values = evaluated_at(self.tree, np.append(low, high[-1]), middle, self.tables)
        found = longest_pieces(
            self.within(low, high, order=3), np.abs(np.diff(values)), np.ptp(values), np.abs(values).max()
        )
        return np.where(np.isnan(found), 0.0, found)


def _between(one: float, other: float, count: int, order: int) -> Enclosure:
    bounds = np.sort([one, other])[:, None]
    return Enclosure((np.broadcast_to(bounds, (2, count)),), order)


class CalmTimes:
    """Times between two limits in which steps meet no feature of some inputs, by a number of equal intervals."""

    def __init__(self, inputs: Sequence[RangedInput], start: float, end: float, cells: int) -> None:
        apart = 2.0 * aside(start, end)
        self._edges = np.linspace(start - apart, end + apart, cells + 1)
        low, high = self._edges[:-1], self._edges[1:]
        self._longest = np.full(cells, np.inf)
        with np.errstate(all="ignore"):
            for each in inputs:
                self._longest = np.minimum(self._longest, PIECES_OF_A_STEP * each.longest(low, high))
                self._longest[_passes(each, low, high)] = 0.0

    def has_step(self, t: float, end: float) -> bool:
        """Return True if a step between two times meets no breakpoint, and is not too long for what inputs do there."""
        first = int(self._edges.searchsorted(t, side="left")) - 1
        last = int(self._edges.searchsorted(end, side="right"))
        inside = self._edges[0] <= t and end <= self._edges[-1]
        return inside and bool(self._longest[max(first, 0) : last].min() >= end - t)


def _passes(each: RangedInput, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return a mask of the intervals in which the expression may have a breakpoint."""
    found = np.zeros(len(low), dtype=bool)
    for node in reading_order(each.tree):
        for condition, levels in conditions(each, node, float(low[0]), float(high[-1])):
            if any(isinstance(part, ast.Name) and part.id == TIME for part in ast.walk(condition)):
                least, largest = each.within(low, high, part=condition).value
                found |= ~(levels.searchsorted(largest, side="right") == levels.searchsorted(least, side="left"))
                found |= np.isnan(least) | np.isnan(largest)
    return found
