"""Rigorous ranges of a formula and of its Taylor coefficients over many time intervals at once.

Interval arithmetic with forward differentiation: Moore, Kearfott, Cloud, Introduction to Interval Analysis (2009),
chapters 2, 6 and 9. Bounds are not rounded outwards; the error is of the order of rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from math import factorial
from typing import TypeAlias

import numpy as np

Operand: TypeAlias = "Enclosure | float"
"""Enclosure, or a number."""
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


def wave(x: Range, top: float) -> Range:
    """Return the range of the cosine wave with a maximum at `top`."""
    ends = np.cos(x - top)
    first_top, first_foot = ((x[0] - top - shift) / (2 * np.pi) for shift in (0.0, np.pi))
    turns = (x[1] - x[0]) / (2 * np.pi)
    high = np.where(np.ceil(first_top) - first_top <= turns, 1.0, ends.max(axis=0))
    low = np.where(np.ceil(first_foot) - first_foot <= turns, -1.0, ends.min(axis=0))
    return np.where(np.isfinite(x).all(axis=0), [low, high], [[-1.0], [1.0]])


ROUNDING = 5 * float(np.finfo(float).eps)
"""Relative rounding error of a value."""
Outer = Callable[[int], Range]
"""Function that returns the range of the k-th Taylor coefficient of a function over the range of its argument."""


@dataclass(frozen=True)
class Enclosure:
    """Ranges of a formula and its time derivatives, interval by interval; infinite if unbounded.

    `coefficients` of shape (2, n): ranges of f, f', f''/2, f'''/6, ... ; omitted ones are zero. `order`: highest
    computed order.
    """

    coefficients: tuple[Range, ...]
    order: int

    __array_ufunc__ = None  # NumPy scalars leave arithmetic to the enclosure

    @classmethod
    def of_time(cls, low: np.ndarray, high: np.ndarray, order: int = 1) -> Enclosure:
        """Return the enclosure of time itself."""
        return cls((np.array([low, high]), np.ones((2, len(low)))), order)

    @property
    def value(self) -> Range:
        """Range of the values."""
        return self.coefficients[0]

    @property
    def slope(self) -> Range:
        """Range of the slopes."""
        return self[1]

    def __getitem__(self, k: int) -> Range:
        """Return the range of the k-th coefficient, zero if omitted."""
        return self.coefficients[k] if k < len(self.coefficients) else np.zeros_like(self.value)

    def constant(self, value: Operand) -> Enclosure:
        """Return a number as an enclosure like this one; an enclosure unchanged."""
        if isinstance(value, Enclosure):
            return value
        return Enclosure((np.full_like(self.value, float(value)),), self.order)

    def __neg__(self) -> Enclosure:
        return Enclosure(tuple(-c[::-1] for c in self.coefficients), self.order)

    def __pos__(self) -> Enclosure:
        return self

    def __add__(self, other: Operand) -> Enclosure:
        if not isinstance(other, Enclosure):
            return Enclosure((self.value + float(other), *self.coefficients[1:]), self.order)
        long, short = sorted((self.coefficients, other.coefficients), key=len, reverse=True)
        added = tuple(total(a, b) for a, b in zip(long, short, strict=False))
        return Enclosure((*added, *long[len(short) :]), self.order)

    __radd__ = __add__

    def __sub__(self, other: Operand) -> Enclosure:
        return self + -other

    def __mul__(self, other: Operand) -> Enclosure:
        if not isinstance(other, Enclosure):
            factor = float(other)
            ordered = slice(None, None, 1 if factor >= 0 else -1)
            scaled = (c[ordered] * factor if factor else np.zeros_like(c) for c in self.coefficients)
            return Enclosure(tuple(scaled), self.order)
        a, b = self.coefficients, other.coefficients
        found = []
        for k in range(min(self.order + 1, len(a) + len(b) - 1)):
            pairs = [(a[i], b[k - i]) for i in range(len(a)) if 0 <= k - i < len(b)]
            found.append(total(*(product(x, y) for x, y in pairs)))
        return Enclosure(tuple(found), self.order)

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> Enclosure:
        return self * (other**-1.0 if isinstance(other, Enclosure) else np.float64(1.0) / other)

    def __pow__(self, power: Operand) -> Enclosure:
        if isinstance(power, Enclosure):
            if len(power.coefficients) > 1 or np.any(power.value != power.value[0, 0]):
                return exp(log(self) * power)
            power = float(power.value[0, 0])
        range_of = power_range if power == int(power) else real_power_range
        binomials = [float(np.prod([(power - i) / (i + 1) for i in range(k)])) for k in range(4)]
        return self.composed(lambda k: scaled(binomials[k], range_of(self.value, power - k)))

    def __rsub__(self, other: Operand) -> Enclosure:
        return -self + other

    def __rtruediv__(self, other: Operand) -> Enclosure:
        return self**-1.0 * other

    def __rpow__(self, other: float) -> Enclosure:
        return exp(self * np.log(other)) if other > 0 else self.constant(other) ** self

    def composed(self, outer: Outer) -> Enclosure:
        """Return a function of this one from the ranges of its Taylor coefficients (Faa di Bruno, to third order)."""
        if len(self.coefficients) == 1:
            return Enclosure((outer(0),), self.order)
        found = [outer(0)]
        u = [self[k] for k in range(self.order + 1)]
        if self.order >= 1:
            found.append(product(outer(1), u[1]))
        if self.order >= 2:
            squared = power_range(u[1], 2)
            found.append(total(product(outer(1), u[2]), product(outer(2), squared)))
        if self.order >= 3:
            mixed = 2.0 * product(outer(2), product(u[1], u[2]))
            found.append(total(product(outer(1), u[3]), mixed, product(outer(3), power_range(u[1], 3))))
        return Enclosure(tuple(found), self.order)

    def where(self, here: np.ndarray, other: Enclosure) -> Enclosure:
        """Return this one on the selected intervals, another one on the others."""
        highest = max(len(self.coefficients), len(other.coefficients))
        return Enclosure(tuple(np.where(here, self[k], other[k]) for k in range(highest)), self.order)

    def narrowed(self, middle: np.ndarray, half: np.ndarray) -> Enclosure:
        """Narrow the values by the mean value form, from the values at interval midpoints and the half lengths."""
        low, high = self.value
        reach = half * np.abs(self.slope).max(axis=0)
        rounding = ROUNDING * np.abs(middle)
        narrower = np.array([np.fmax(low, middle - reach - rounding), np.fmin(high, middle + reach + rounding)])
        return Enclosure((narrower, *self.coefficients[1:]), self.order)

    def derivative(self) -> Enclosure:
        """Return the enclosure of f', of one order less."""
        shifted = tuple(k * c for k, c in enumerate(self.coefficients))[1:] or (np.zeros_like(self.value),)
        return Enclosure(shifted, self.order - 1)


def scaled(factor: float, x: Range) -> Range:
    """Return a range times a number; zero times infinity is zero."""
    if factor == 0.0:
        return np.zeros_like(x)
    return factor * (x if factor > 0 else x[::-1])


def unbounded(value: Range, order: int, slope: Range = EVERYWHERE) -> Enclosure:
    """Return an enclosure with unbounded derivatives, except perhaps the first."""
    everywhere = np.broadcast_to(EVERYWHERE, value.shape)
    return Enclosure((value, np.broadcast_to(slope, value.shape), *[everywhere] * (order - 1)), order)


def exp(x: Enclosure) -> Enclosure:
    """Return the exponential; its Taylor coefficients are exp(x)/k!."""
    values = np.exp(x.value)
    return x.composed(lambda k: values / factorial(k))


def log(x: Enclosure) -> Enclosure:
    """Return the natural logarithm; NaN where the whole range is negative."""

    def outer(k: int) -> Range:
        if k == 0:
            return np.log(np.where(x.value[1] < 0, np.nan, np.maximum(x.value, 0.0)))
        return scaled((-1.0) ** (k + 1) / k, real_power_range(x.value, -k))

    return x.composed(outer)


def absolute(x: Enclosure) -> Enclosure:
    """Return the absolute value; where x changes sign, the slope has the range of both signs."""
    straddles = (x.value[0] < 0) & (x.value[1] > 0)
    one_sided = x.where(x.value[0] >= 0, -x)
    both = unbounded(power_range(x.value, 2) ** 0.5, x.order, hull(x.slope, -x.slope[::-1]))
    return both.where(straddles, one_sided)


def sign(x: Enclosure) -> Enclosure:
    """Return -1, 0 or 1; derivatives are unbounded where x may be zero."""
    return unbounded(np.sign(x.value), x.order).where(around_zero(x.value), Enclosure((np.sign(x.value),), x.order))


def _choice(greatest: bool) -> Callable[..., Enclosure]:
    """Return min or max: one argument where ranges are disjoint, else with the hull of both slopes."""

    def pair(a: Enclosure, b: Enclosure) -> Enclosure:
        """Return the minimum or maximum of two enclosures."""
        low, high = (a, b) if greatest else (b, a)
        value = np.maximum(a.value, b.value) if greatest else np.minimum(a.value, b.value)
        open_one = unbounded(value, a.order, hull(a.slope, b.slope))
        settled = b.where(low.value[1] <= high.value[0], a)
        return settled.where((a.value[1] <= b.value[0]) | (b.value[1] <= a.value[0]), open_one)

    def of(*parts: Operand) -> Enclosure:
        """Return the minimum or maximum of all arguments, one after the other."""
        known = next(part for part in parts if isinstance(part, Enclosure))
        chosen, *others = (known.constant(part) for part in parts)
        for other in others:
            chosen = pair(chosen, other)
        return chosen

    return of


minimum, maximum = _choice(False), _choice(True)


def branch(x: Operand, below: Operand, at: Operand, above: Operand) -> Enclosure:
    """Return one of three values by the sign of the first; it jumps where that may be zero."""
    known = next(part for part in (x, below, at, above) if isinstance(part, Enclosure))
    sign_of, *values = (known.constant(part) for part in (x, below, at, above))
    settled = values[0].where(sign_of.value[1] < 0, values[2])
    jumping = unbounded(hull(*(value.value for value in values)), known.order)
    return jumping.where(around_zero(sign_of.value), settled)


def atan2(y: Operand, x: Operand) -> Enclosure:
    """Return atan2 from the corners of the box of x and y; it jumps where the box meets the negative x axis."""
    known = next(part for part in (y, x) if isinstance(part, Enclosure))
    y, x = known.constant(y), known.constant(x)
    jumps = (x.value[0] <= 0) & (y.value[0] <= 0) & (y.value[1] >= 0)
    breakpoints = np.array([np.arctan2(y.value[i], x.value[j]) for i in (0, 1) for j in (0, 1)])
    value = np.array([breakpoints.min(axis=0), breakpoints.max(axis=0)])
    turning = (y.derivative() * x - x.derivative() * y) / (x**2.0 + y**2.0)
    rates = (turning[k] / (k + 1) for k in range(known.order))
    jumping = unbounded(np.broadcast_to([[-np.pi], [np.pi]], value.shape), known.order)
    return jumping.where(jumps, Enclosure((value, *rates), known.order))
