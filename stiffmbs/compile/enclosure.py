"""Ranges of a formula and of its slope over many stretches of time at once, so that no zero of it is missed.

Interval arithmetic with forward differentiation: Moore, Kearfott, Cloud, Introduction to Interval Analysis (2009),
chapters 2 and 6.  Ends are not rounded outwards; a range that overlooks zero by rounding overlooks it by as much.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

Range = np.ndarray
"""Least and greatest values, shape (2, n)."""


@dataclass(frozen=True)
class Enclosure:
    """Where a formula's values and its slopes in time lie, stretch by stretch; infinite where there is no bound.

    Attributes
    ----------
    value, slope : ndarrays, shape (2, n)
    """

    value: Range
    slope: Range

    __array_ufunc__ = None  # numpy's numbers leave arithmetic with an enclosure to it

    @classmethod
    def of_time(cls, low: np.ndarray, high: np.ndarray) -> Enclosure:
        """Time itself."""
        return cls(np.array([low, high]), np.ones((2, len(low))))

    def _other(self, other: Any) -> Enclosure:
        if isinstance(other, Enclosure):
            return other
        return Enclosure(np.full_like(self.value, float(other)), np.zeros_like(self.value))

    def __neg__(self) -> Enclosure:
        return Enclosure(-self.value[::-1], -self.slope[::-1])

    def __pos__(self) -> Enclosure:
        return self

    def __add__(self, other: Any) -> Enclosure:
        other = self._other(other)
        return Enclosure(self.value + other.value, self.slope + other.slope)

    def __sub__(self, other: Any) -> Enclosure:
        return self + -self._other(other)

    def __mul__(self, other: Any) -> Enclosure:
        other = self._other(other)
        slope = _product(self.slope, other.value) + _product(self.value, other.slope)
        return Enclosure(_product(self.value, other.value), slope)

    def __truediv__(self, other: Any) -> Enclosure:
        return self * self._other(other)._inverse()

    def __pow__(self, power: Any) -> Enclosure:
        if isinstance(power, Enclosure):
            if np.any(power.slope) or np.any(power.value != power.value[0, 0]):
                return exp(log(self) * power)
            power = float(power.value[0, 0])
        if power == int(power) and abs(power) < MOST_FACTORS:
            product = reduce(lambda a, b: a * b, [self] * int(abs(power)), self._other(1.0))
            even = power % 2 == 0
            positive = Enclosure(np.maximum(product.value, 0.0), product.slope) if even else product
            return positive if power >= 0 else positive._inverse()
        return exp(log(self) * power)

    def __radd__(self, other: Any) -> Enclosure:
        return self + other

    def __rsub__(self, other: Any) -> Enclosure:
        return self._other(other) - self

    def __rmul__(self, other: Any) -> Enclosure:
        return self * other

    def __rtruediv__(self, other: Any) -> Enclosure:
        return self._other(other) / self

    def __rpow__(self, other: Any) -> Enclosure:
        return self._other(other) ** self

    def _inverse(self) -> Enclosure:
        around = (self.value[0] <= 0) & (self.value[1] >= 0)
        value = np.where(around, _EVERYWHERE, 1 / self.value[::-1])
        return Enclosure(value, np.where(around, _EVERYWHERE, -_product(self.slope, _product(value, value))[::-1]))

    def composed(self, value: Range, derivative: Range) -> Enclosure:
        """A function of this one, by its own range and that of its derivative."""
        return Enclosure(value, _product(derivative, self.slope))


MOST_FACTORS = 64
_EVERYWHERE = np.array([[-np.inf], [np.inf]])


def _product(a: Range, b: Range) -> Range:
    parts = np.array([a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]])
    parts[np.isnan(parts)] = 0.0  # zero times infinity: the bound of the other factor's ends
    return np.array([parts.min(axis=0), parts.max(axis=0)])


def _rising(function: Callable, derivative: Callable[[Range], Range]) -> Callable[[Enclosure], Enclosure]:
    """A function that never falls, by its ends; outside its domain it has no values."""
    return lambda x: x.composed(function(x.value), derivative(x.value))


def _wave(x: Range, top: float) -> Range:
    """The range of the cosine wave whose tops are at `top` and a whole number of turns from there."""
    ends = np.cos(x - top)
    first_top, first_foot = ((x[0] - top - shift) / (2 * np.pi) for shift in (0.0, np.pi))
    turns = (x[1] - x[0]) / (2 * np.pi)
    high = np.where(np.ceil(first_top) - first_top <= turns, 1.0, ends.max(axis=0))
    low = np.where(np.ceil(first_foot) - first_foot <= turns, -1.0, ends.min(axis=0))
    return np.where(np.isfinite(x).all(axis=0), [low, high], [[-1.0], [1.0]])


def sin(x: Enclosure) -> Enclosure:
    return x.composed(_wave(x.value, np.pi / 2), _wave(x.value, 0.0))


def cos(x: Enclosure) -> Enclosure:
    return x.composed(_wave(x.value, 0.0), _wave(x.value, -np.pi / 2))


def absolute(x: Enclosure) -> Enclosure:
    low, high = x.value
    least = np.where((low <= 0) & (high >= 0), 0.0, np.minimum(np.abs(low), np.abs(high)))
    return x.composed(np.array([least, np.maximum(np.abs(low), np.abs(high))]), np.sign(x.value))


def sign(x: Enclosure) -> Enclosure:
    jumps = (x.value[0] <= 0) & (x.value[1] >= 0)
    return Enclosure(np.sign(x.value), np.where(jumps, _EVERYWHERE, 0.0))


def _hull(choose: Callable) -> Callable[..., Enclosure]:
    """min or max: the slope is that of one of them."""

    def of(*parts: Any) -> Enclosure:
        known = next(part for part in parts if isinstance(part, Enclosure))
        all_parts = [known._other(part) for part in parts]
        slopes = np.array([part.slope for part in all_parts])
        value = reduce(choose, [part.value for part in all_parts])
        return Enclosure(value, np.array([slopes[:, 0].min(axis=0), slopes[:, 1].max(axis=0)]))

    return of


minimum, maximum = _hull(np.minimum), _hull(np.maximum)


def step(x: Any, x0: Any, h0: Any, x1: Any, h1: Any) -> Enclosure:
    z = minimum(maximum((x - x0) / (x1 - x0), 0.0), 1.0)
    return h0 + (h1 - h0) * (z * z * (3 - 2 * z))


def step5(x: Any, x0: Any, h0: Any, x1: Any, h1: Any) -> Enclosure:
    z = minimum(maximum((x - x0) / (x1 - x0), 0.0), 1.0)
    return h0 + (h1 - h0) * (z * z * z * (10 - 15 * z + 6 * z * z))


def branch(x: Any, below: Any, at: Any, above: Any) -> Enclosure:
    """One of three by the sign of the first; it jumps where that may be zero."""
    known = next(part for part in (x, below, at, above) if isinstance(part, Enclosure))
    sign_of, *values = (known._other(part) for part in (x, below, at, above))
    low, high = sign_of.value
    jumps = (low <= 0) & (high >= 0)
    first, middle, last = (part.value for part in values)
    hull = np.array([np.minimum.reduce([first, middle, last])[0], np.maximum.reduce([first, middle, last])[1]])
    value = np.where(jumps, hull, np.where(high < 0, first, last))
    slope = np.where(jumps, _EVERYWHERE, np.where(high < 0, values[0].slope, values[2].slope))
    return Enclosure(value, slope)


def atan2(y: Any, x: Any) -> Enclosure:
    """By the corners of the box of x and y; it jumps where that meets the negative x axis."""
    known = y if isinstance(y, Enclosure) else x
    y, x = known._other(y), known._other(x)
    jumps = (x.value[0] <= 0) & (y.value[0] <= 0) & (y.value[1] >= 0)
    corners = np.array([np.arctan2(y.value[i], x.value[j]) for i in (0, 1) for j in (0, 1)])
    value = np.where(jumps, [[-np.pi], [np.pi]], [corners.min(axis=0), corners.max(axis=0)])
    turning = _product(x.value, y.slope) - _product(y.value, x.slope)[::-1]
    slope = _product(turning, (x**2 + y**2)._inverse().value)
    return Enclosure(value, np.where(jumps, _EVERYWHERE, slope))


def _positive(x: Range) -> Range:
    return np.where(x[1] < 0, np.nan, np.maximum(x, 0.0))


sqrt = _rising(lambda x: np.sqrt(_positive(x)), lambda x: 0.5 / np.sqrt(_positive(x))[::-1])
exp = _rising(np.exp, np.exp)
log = _rising(lambda x: np.log(_positive(x)), lambda x: 1 / _positive(x)[::-1])
sinh = _rising(np.sinh, lambda x: np.array([np.ones_like(x[0]), np.cosh(x).max(axis=0)]))
tanh = _rising(np.tanh, lambda x: np.broadcast_to([[0.0], [1.0]], x.shape))
atan = _rising(np.arctan, lambda x: np.broadcast_to([[0.0], [1.0]], x.shape))
asin = _rising(
    lambda x: np.where((x[1] < -1) | (x[0] > 1), np.nan, np.arcsin(np.clip(x, -1, 1))),
    lambda x: np.broadcast_to([[1.0], [np.inf]], x.shape),
)
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": sin, "cos": cos, "tan": lambda x: sin(x) / cos(x), "sqrt": sqrt, "exp": exp, "log": log,
    "sinh": sinh, "cosh": lambda x: x.composed(np.cosh(absolute(x).value), np.sinh(x.value)), "tanh": tanh, "atan": atan, "asin": asin,
    "acos": lambda x: np.pi / 2 - asin(x), "atan2": atan2, "abs": absolute, "sign": sign,
    "min": minimum, "max": maximum, "step": step, "step5": step5, "branch": branch,
}  # fmt: skip
"""The functions of formulas."""
