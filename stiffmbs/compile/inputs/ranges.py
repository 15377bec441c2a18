"""Interval arithmetic on arrays of lower and upper bounds, shape (2, n)."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce

import numpy as np

Range = np.ndarray
"""Lower and upper bounds, shape (2, n); NaN if undefined, infinite if unbounded."""
EVERYWHERE = np.array([[-np.inf], [np.inf]])


def total(*ranges: Range) -> Range:
    """Return the sum; infinite bounds of opposite signs give an unbounded range."""
    found = reduce(np.add, ranges)
    lost = np.isnan(found)
    if lost.any():
        lost &= ~reduce(np.logical_or, (np.isnan(each) for each in ranges))
        found = np.where(lost, EVERYWHERE, found)
    return found


def product(a: Range, b: Range) -> Range:
    """Return the product; zero times infinity is zero."""
    parts = np.array([a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]])
    lost = np.isnan(parts)
    if lost.any():
        parts[lost & ~(np.isnan(a) | np.isnan(b)).any(axis=0)] = 0.0
    return np.array([parts.min(axis=0), parts.max(axis=0)])


def hull(*ranges: Range) -> Range:
    """Return the smallest range that contains all."""
    return np.array(
        [reduce(np.minimum, [each[0] for each in ranges]), reduce(np.maximum, [each[1] for each in ranges])]
    )


def around_zero(x: Range) -> np.ndarray:
    """Return a mask of the ranges that contain zero."""
    return (x[0] <= 0) & (x[1] >= 0)


def between_turns(function: Callable[[np.ndarray], np.ndarray], x: Range, turns: tuple[float, ...]) -> Range:
    """Return the range of a function that is monotonic between its extrema `turns`; NaN entries are ignored."""
    values = [function(argument) for argument in (*x, *(np.clip(p, *x) for p in turns))]
    return np.array([reduce(np.fmin, values), reduce(np.fmax, values)])


def power_range(x: Range, power: float) -> Range:
    """Return the range of an integer power."""
    if power == 0:
        return np.ones_like(x)
    if power > 0:
        return between_turns(lambda y: y**power, x, (0.0,))
    ends = x**power
    return np.where(around_zero(x), EVERYWHERE, [ends.min(axis=0), ends.max(axis=0)])


def real_power_range(x: Range, power: float) -> Range:
    """Return the range of a power of a non-negative number; NaN for negative ranges."""
    ends = np.where(x[1] < 0, np.nan, np.maximum(x, 0.0)) ** power
    return np.array([ends.min(axis=0), ends.max(axis=0)])


def real_binomial(n: float, k: int) -> float:
    """Return the binomial coefficient n over k."""
    return float(np.prod([(n - i) / (i + 1) for i in range(k)]))


def wave(x: Range, top: float) -> Range:
    """Return the range of the cosine wave with a maximum at `top`."""
    ends = np.cos(x - top)
    first_top, first_foot = ((x[0] - top - shift) / (2 * np.pi) for shift in (0.0, np.pi))
    turns = (x[1] - x[0]) / (2 * np.pi)
    high = np.where(np.ceil(first_top) - first_top <= turns, 1.0, ends.max(axis=0))
    low = np.where(np.ceil(first_foot) - first_foot <= turns, -1.0, ends.min(axis=0))
    return np.where(np.isfinite(x).all(axis=0), [low, high], [[-1.0], [1.0]])
