"""Ranges of table values and Taylor coefficients over intervals of the argument."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...reading.table import Table
from ..table_values import curve, parts_of
from .distinct import distinct
from .interval_arithmetic import EVERYWHERE, Enclosure, Range, between_turns, hull
from .zeros import MOST_STRETCHES, TooMany


class TableRanges:
    """Table as a function of arrays and of enclosures.

    `breakpoints`: arguments of its breakpoints, within one period for a periodic table. `bends`: these, and the points at
    which its curvature jumps: forces jump there if it prescribes a position. `period`: zero if it is not periodic.
    """

    def __init__(self, table: Table) -> None:
        self.table = table
        self._values = curve(table)
        self._x, self._pieces = parts_of(table)
        self._smooth = {"lines": 1, "spline": 3, "smoothing": 3}.get(table.interpolation, 2)
        self.period = self._x[-1] - self._x[0] if table.repeats else 0.0
        self._holds = table.beyond == "hold"
        self.breakpoints = _breakpoints(table, self._x)
        self.bends = distinct(self.breakpoints, _jumps_of_curvature(self._x, self._pieces))
        h = np.diff(self._x)
        whole = np.array([np.zeros_like(h), h])
        with np.errstate(all="ignore"):
            self._whole = [self._of_pieces(np.arange(len(h)), whole, k) for k in range(4)]

    def values(self, arguments: np.ndarray) -> np.ndarray:
        """Return the values as computed by kernels."""
        return self._values(arguments)

    def breakpoints_between(self, low: float, high: float, bends: bool = False) -> np.ndarray:
        """Return the breakpoints between two arguments, with jumps of the curvature if `bends` is true."""
        breakpoints = self.bends if bends else self.breakpoints
        if not self.period:
            return breakpoints[(breakpoints >= low) & (breakpoints <= high)]
        first, last = np.floor((low - self._x[0]) / self.period), np.ceil((high - self._x[0]) / self.period)
        if not (last - first) * len(breakpoints) <= MOST_STRETCHES:
            raise TooMany(
                f"a periodic table has more than {MOST_STRETCHES:.0e} breakpoints between {low:g} and {high:g}, expected fewer"
            )
        turns = np.arange(first, last + 1)
        found = distinct(breakpoints + turns[:, None] * self.period)
        return found[(found >= low) & (found <= high)]

    def enclosed(self, argument: Enclosure) -> Enclosure:
        """Return the enclosure of the table for an argument."""
        low, high = argument.value
        bounded = np.isfinite(low) & np.isfinite(high)
        a, b = np.where(bounded, low, self._x[0]), np.where(bounded, high, self._x[-1])
        outer = self._around(a, b) if self.period else self._over(a, b)
        return argument.composed(lambda k: np.where(bounded, outer(k), EVERYWHERE))

    def _around(self, a: np.ndarray, b: np.ndarray) -> Callable[[int], Range]:
        """Return the ranges of Taylor coefficients of a periodic table; intervals are split at the end of a period."""
        first, last, period = self._x[0], self._x[-1], self.period
        length = np.minimum(b - a, period)
        begin = first + np.mod(a - first, period)
        end = begin + length
        before, behind = self._over(begin, np.minimum(end, last)), self._over(np.full_like(a, first), end - period)
        wraps = end > last
        return lambda k: np.where(wraps, self._joined(before(k), behind(k), k), before(k))

    def _joined(self, before: Range, behind: Range, k: int) -> Range:
        return hull(before, behind) if k <= self._smooth else np.broadcast_to(EVERYWHERE, before.shape)

    def _over(self, a: np.ndarray, b: np.ndarray) -> Callable[[int], Range]:
        """Return the ranges of Taylor coefficients over intervals; outside, a table is straight."""
        x = self._x
        inside = np.clip([a, b], x[0], x[-1])
        first, last = np.clip(np.searchsorted(x, inside, side="right") - 1, 0, len(x) - 2)
        last = np.maximum(np.where(inside[1] <= x[last], last - 1, last), first)
        same = first == last
        z_first = np.array([inside[0] - x[first], np.where(same, inside[1], x[first + 1]) - x[first]])
        z_last = np.array([np.where(same, inside[0], x[last]) - x[last], inside[1] - x[last]])
        outside = (a < x[0]) | (b > x[-1])
        beyond = (b <= x[0]) | (a >= x[-1])

        def outer(k: int) -> Range:
            """Return the range of the k-th Taylor coefficient over an interval."""
            found = hull(self._of_pieces(first, z_first, k), self._of_pieces(last, z_last, k))
            between = np.flatnonzero(last > first + 1)
            found[:, between] = hull(found[:, between], _hulls(self._whole[k], first[between] + 1, last[between]))
            if k > self._smooth:
                found = np.where(same, found, EVERYWHERE)
            if k == 0:
                ends = self._values(np.array([a, b]))
                return np.where(outside, hull(found, ends[[0, 0]], ends[[1, 1]]), found)
            if k > 1 or self._holds:
                crossed = (
                    hull(found, np.zeros_like(found))
                    if k == (1 if self._holds else 2)
                    else np.broadcast_to(EVERYWHERE, found.shape)
                )
                return np.where(beyond, 0.0, np.where(outside, crossed, found))
            return found

        return outer

    def _of_pieces(self, piece: np.ndarray, z: Range, k: int) -> Range:
        """Return the range of the k-th Taylor coefficient within pieces, over intervals relative to their starts."""
        a, b, c, d = self._pieces[piece].T
        if k == 3:
            return np.array([np.minimum(a, 0.0), np.maximum(a, 0.0)])  # contains 0, so that no cubic counts as smooth
        if k == 2:
            return np.sort(3 * a * z + b, axis=0)
        if k == 1:
            return between_turns(lambda y: (3 * a * y + 2 * b) * y + c, z, (-b / (3 * a),))
        root = np.sqrt(b * b - 3 * a * c)
        far = -(b + np.copysign(root, b))
        return between_turns(lambda y: ((a * y + b) * y + c) * y + d, z, (far / (3 * a), c / far))


def _breakpoints(table: Table, x: np.ndarray) -> np.ndarray:
    """Return the breakpoints of a table: its ends, kinks of straight lines, and the ends of flat parts."""
    y = np.array([value for _, value in table.table])
    if table.lines:
        slopes = np.diff(y) / np.diff(x)
        bends = np.flatnonzero(np.diff(slopes)) + 1
    else:
        flat = np.abs(np.diff(y)) <= FLAT * np.max(np.abs(y), initial=0.0)
        bends = np.flatnonzero(flat[1:] != flat[:-1]) + 1
        if table.repeats and not flat.any():
            return np.empty(0)
    return x[np.unique(np.concatenate([[0], bends, [len(x) - 1]]))]


def _jumps_of_curvature(x: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """Return the inner points of a table at which its second derivative jumps by more than rounding."""
    a, b, _, _ = pieces.T
    before, after = (6 * a * np.diff(x) + 2 * b)[:-1], 2 * b[1:]
    size = np.max(np.abs([before, after]), initial=0.0)
    return x[1:-1][np.abs(after - before) > CONTINUOUS * size]


CONTINUOUS = 1e-6
"""Jump of a second derivative, relative to the largest one of a table, that is rounding."""
FLAT = 1e-12
"""Change between two points of a table, relative to its largest value, below which it is flat."""


def _hulls(ranges: Range, first: np.ndarray, end: np.ndarray) -> Range:
    """Return the hulls of successive ranges from each first index to before each end."""
    places = np.stack([first, end], axis=1).ravel()
    low, high = np.pad(ranges, ((0, 0), (0, 1)))  # an end may be beyond the last range
    return np.array([np.minimum.reduceat(low, places)[::2], np.maximum.reduceat(high, places)[::2]])
