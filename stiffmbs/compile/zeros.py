"""All instants at which a formula of time changes its sign, however close to each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from .enclosure import Enclosure

AT_ONCE = 64
"""Stretches that the search begins with."""
SHORTEST = 1e-12
"""Length of a stretch, in parts of the times themselves, in which no more than one sign is looked for."""
MOST = 1_000_000
"""Stretches at which the search is given up."""

Values = Callable[[np.ndarray], np.ndarray]
Ranges = Callable[[np.ndarray, np.ndarray], Enclosure]


class TooMany(Exception):
    """A formula changes its sign too often."""


def zeros(values: Values, ranges: Ranges, start: float, end: float) -> np.ndarray:
    """Instants of a change of sign between two times, in no order.

    A stretch is halved until the formula's range leaves zero out, or its slope keeps one sign there, so that the
    signs at the ends tell all.  Straight lines need no search.

    Parameters
    ----------
    values : callable
        Of instants.
    ranges : callable
        Of the beginnings and ends of stretches.
    start, end : float
        s.

    Raises
    ------
    TooMany
    """
    with np.errstate(all="ignore"):
        first, last = values(np.array([start, end]))
        slope = ranges(np.array([start]), np.array([end])).slope[:, 0]
        if np.isfinite(slope[0]) and slope[0] == slope[1]:
            return start + (end - start) * first / (first - last) * np.ones(int(first != last))
        stretches = list(_stretches(values, ranges, start, end))
        return _bisected(values, *np.concatenate(stretches, axis=1)) if stretches else np.empty(0)


def _stretches(values: Values, ranges: Ranges, start: float, end: float) -> Iterator[np.ndarray]:
    """Beginnings and ends of stretches of one slope, or as short as time can be told apart, that may hold a change."""
    shortest = SHORTEST * max(abs(start), abs(end))
    edges = np.linspace(start, end, AT_ONCE + 1)
    low, high = edges[:-1], edges[1:]
    while len(low):
        found = ranges(low, high)
        middle = (low + high) / 2
        around = _around_zero(found, values(middle), middle, low, high)
        one_way = (found.slope[0] > 0) | (found.slope[1] < 0)
        settled = around & (one_way | (high - low <= shortest))
        yield np.array([low[settled], high[settled]])
        open_ones = around & ~settled
        low, middle, high = low[open_ones], middle[open_ones], high[open_ones]
        if len(low) > MOST:
            raise TooMany(f"found more than {MOST:.0e} corners between {start:g} and {end:g} s, expected fewer")
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])


def _around_zero(
    found: Enclosure, at_middle: np.ndarray, middle: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Which stretches may hold a change of sign, by their ranges and by the slope from their middle.

    Where the formula stands still it changes no sign, whatever its value.
    """
    half = np.maximum(high - middle, middle - low) * np.abs(found.slope).max(axis=0)
    moving = np.any(found.slope != 0, axis=0)
    near = ~(np.abs(at_middle) > half)  # also where the bound of the slope is infinite
    return moving & near & (found.value[0] <= 0) & (found.value[1] >= 0)


def _bisected(values: Values, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where the sign changes in each stretch; stretches without a change have none, a zero at an end counts."""
    first, last = values(low), values(high)
    at_ends = np.concatenate([low[first == 0], high[last == 0]])
    changes = first * last < 0
    low, high, rising = low[changes], high[changes], last[changes] > 0
    while np.any((low < (middle := (low + high) / 2)) & (middle < high)):
        beyond = (values(middle) > 0) == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return np.concatenate([at_ends, high])
