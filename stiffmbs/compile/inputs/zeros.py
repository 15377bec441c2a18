"""All times at which a formula of time crosses given levels."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from .interval_arithmetic import ROUNDING, Enclosure

FIRST_STRETCHES = 64
"""Initial number of intervals of the search."""
SHORTEST_STRETCH = 1e-12
"""Length, relative to the times, of an interval with at most one crossing: the smallest distance of breakpoints."""
MOST_STRETCHES = 1_000_000
"""Number of intervals at which the search is given up."""
MANY_STRETCHES = 4 * FIRST_STRETCHES
"""Number of intervals above which those are dropped where the formula equals a level up to rounding."""
RANGE_ROUNDING = 1.5 * float(np.finfo(float).eps)
"""Rounding of ranges of a formula, relative to its values."""

Values = Callable[[np.ndarray], np.ndarray]
Ranges = Callable[[np.ndarray, np.ndarray], Enclosure]
ZERO = np.zeros(1)


class TooMany(Exception):
    """A formula crosses its levels too often."""


def zeros(values: Values, ranges: Ranges, start: float, end: float, levels: np.ndarray = ZERO) -> np.ndarray:
    """Return the times between two limits at which a formula crosses zero or other levels, unsorted.

    An interval is halved until the formula's range excludes all levels, or its slope has one sign so that end values
    suffice. Straight lines need no search. A formula that stays at a level does not cross it. `values`: function of
    times. `ranges`: function of starts and ends of intervals. `start`, `end`: s. `levels`: increasing. Raises TooMany.
    """
    with np.errstate(all="ignore"):
        first, last = values(np.array([start, end]))
        slope = ranges(np.array([start]), np.array([end])).slope[:, 0]
        if np.isfinite(slope[0]) and slope[0] == slope[1]:
            if first == last:
                return np.empty(0)
            found = start + (end - start) * (levels - first) / (last - first)
            near = (found >= start) & (found <= end)
            return _of_line(values, found[near], levels[near], bool(last > first), max(abs(start), abs(end)))
        stretches = list(_stretches(values, ranges, start, end, levels))
        low, high = np.concatenate([np.empty((2, 0)), *stretches], axis=1)
        return _passages(values, low, high, levels)


def _of_line(values: Values, found: np.ndarray, levels: np.ndarray, rising: bool, size: float) -> np.ndarray:
    """Return the crossings of a straight line to the last digit, from values that rounding has moved."""
    low, high = found - RANGE_ROUNDING * size, found + RANGE_ROUNDING * size
    closed = ((values(low) < levels) == rising) & ((values(high) > levels) == rising) & (values(found) != levels)
    if closed.any():
        found[closed] = _bisected(values, low[closed], high[closed], levels[closed], np.full(closed.sum(), rising))
    return found


def _stretches(values: Values, ranges: Ranges, start: float, end: float, levels: np.ndarray) -> Iterator[np.ndarray]:
    """Yield starts and ends of intervals that may hold a crossing, monotonic or at the resolution of time."""
    shortest = SHORTEST_STRETCH * max(abs(start), abs(end))
    edges = np.linspace(start, end, FIRST_STRETCHES + 1)
    low, high = edges[:-1], edges[1:]
    size = 0.0
    while len(low):
        found = ranges(low, high)
        size = size or _size(found.value)
        middle = (low + high) / 2
        around = _around(levels, found, values(middle), middle, low, high) & ~_stays(found.value, levels, size)
        monotonic = (found.slope[0] > 0) | (found.slope[1] < 0)
        settled = around & (monotonic | (high - low <= shortest))
        yield np.array([low[settled], high[settled]])
        open_ones = around & ~settled
        if np.count_nonzero(open_ones) > MANY_STRETCHES:
            open_ones[open_ones] = ~_stands(values, low[open_ones], high[open_ones], levels, size)
        low, middle, high = low[open_ones], middle[open_ones], high[open_ones]
        if len(low) > MOST_STRETCHES:
            raise TooMany(
                f"found more than {MOST_STRETCHES:.0e} breakpoints between {start:g} and {end:g} s, expected fewer"
            )
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])


def _size(value: np.ndarray) -> float:
    finite = value[np.isfinite(value)]
    return float(np.max(np.abs(finite), initial=0.0))


def _around(
    levels: np.ndarray, found: Enclosure, at_middle: np.ndarray, middle: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Return a mask of the intervals that may hold a crossing, by their ranges and by the slope from their middle.

    A constant formula crosses nothing.
    """
    half = np.maximum(high - middle, middle - low) * np.abs(found.slope).max(axis=0)
    moving = np.any(found.slope != 0, axis=0)
    half = np.where(np.isfinite(half), half, np.inf)
    least, most = np.fmax(at_middle - half, found.value[0]), np.fmin(at_middle + half, found.value[1])
    return moving & (np.searchsorted(levels, least, side="left") < np.searchsorted(levels, most, side="right"))


def _stays(value: np.ndarray, levels: np.ndarray, size: float) -> np.ndarray:
    """Return a mask of the intervals whose range equals one level up to rounding."""
    k = np.clip(np.searchsorted(levels, value[0] - RANGE_ROUNDING * size), 0, len(levels) - 1)
    return (np.abs(value - levels[k]) <= RANGE_ROUNDING * size).all(axis=0)


def _stands(values: Values, low: np.ndarray, high: np.ndarray, levels: np.ndarray, size: float) -> np.ndarray:
    """Return a mask of the intervals whose samples equal a level up to rounding."""
    standing = np.ones(len(low), dtype=bool)
    for part in (0.0, 0.17, 0.5, 0.83, 1.0):
        at = values(low + part * (high - low))
        k = np.clip(np.searchsorted(levels, at), 1, len(levels) - 1) if len(levels) > 1 else 0
        miss = np.minimum(np.abs(at - levels[k]), np.abs(at - levels[np.maximum(k - 1, 0)]))
        standing &= miss <= 10 * ROUNDING * size
    return standing


def _passages(values: Values, low: np.ndarray, high: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Return the crossings in monotonic intervals by bisection; end values equal to a level count.

    In an interval at the resolution of time, a formula may stay at a level before it leaves it, or after it has reached it.
    """
    first, last = values(low), values(high)
    leaves, reaches = np.isin(first, levels), np.isin(last, levels)
    at_ends = np.concatenate(
        [
            _left(values, low[leaves], high[leaves], first[leaves]),
            _left(values, high[reaches], low[reaches], last[reaches]),
        ]
    )
    least, most = np.minimum(first, last), np.maximum(first, last)
    from_level = np.searchsorted(levels, least, side="right")
    count = np.maximum(np.searchsorted(levels, most, side="left") - from_level, 0)
    stretch = np.repeat(np.arange(len(low)), count)
    within = np.arange(len(stretch)) - np.repeat(np.cumsum(count) - count, count)
    level = levels[from_level[stretch] + within]
    return np.concatenate([at_ends, _bisected(values, low[stretch], high[stretch], level, (last > first)[stretch])])


def _left(values: Values, at: np.ndarray, other: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Return the last numbers from given ones, where a formula equals a level, towards others at which it still does so."""
    begun, at = at, at.copy()
    other = np.where(values(other) == level, begun, other)
    while np.any(((middle := (at + other) / 2) != at) & (middle != other)):
        stays = values(middle) == level
        at, other = np.where(stays, middle, at), np.where(stays, other, middle)
    return at


def _bisected(values: Values, low: np.ndarray, high: np.ndarray, level: np.ndarray, rising: np.ndarray) -> np.ndarray:
    """Return the first numbers beyond a level in monotonic intervals that hold one crossing each."""
    while np.any((low < (middle := (low + high) / 2)) & (middle < high)):
        beyond = (values(middle) > level) == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return high
