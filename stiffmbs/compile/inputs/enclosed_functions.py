"""Enclosures of the functions of formulas."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from math import factorial

import numpy as np

from ...reading.formula.functions import IN_FORMULAS, FormulaFunction, step5_value, step_value
from ...reading.formula.text import evaluate, parse
from .interval_arithmetic import (  # noqa: F401 (the table of functions names them)
    EVERYWHERE,
    Enclosure,
    Operand,
    Range,
    absolute,
    atan2,
    between_turns,
    branch,
    exp,
    hull,
    log,
    maximum,
    minimum,
    power_range,
    product,
    real_power_range,
    scaled,
    sign,
    wave,
)


def _composed(coefficient: Callable[[Range, int], Range]) -> Callable[[Enclosure], Enclosure]:
    """Return a function of enclosures from the range of its k-th Taylor coefficient over a range."""
    return lambda x: x.composed(partial(coefficient, x.value))


@_composed
def cos(x: Range, k: int) -> Range:
    """Return the cosine wave; each derivative shifts it by a quarter period."""
    return wave(x, -k * np.pi / 2) / factorial(k)


@_composed
def sin(x: Range, k: int) -> Range:
    """Return the cosine wave a quarter period later."""
    return wave(x, np.pi / 2 - k * np.pi / 2) / factorial(k)


@_composed
def sinh(x: Range, k: int) -> Range:
    """Return sinh and cosh in turn, which are each other's derivatives."""
    return (between_turns(np.cosh, x, (0.0,)) if k % 2 else np.sinh(x)) / factorial(k)


@_composed
def cosh(x: Range, k: int) -> Range:
    """Return cosh and sinh in turn."""
    return (np.sinh(x) if k % 2 else between_turns(np.cosh, x, (0.0,))) / factorial(k)


@_composed
def tanh(x: Range, k: int) -> Range:
    """Return tanh: T' = 1 - T^2, T''/2 = -T T', T'''/6 = -T' (1 - 3 T^2)/3."""
    T = np.tanh(x)
    rate = between_turns(lambda z: 1 / np.cosh(z) ** 2, x, (0.0,))
    return (T, rate, -product(T, rate)[::-1], product(rate, (3 * power_range(T, 2) - 1) / 3))[k]


@_composed
def atan(x: Range, k: int) -> Range:
    """Return the arctangent: with x = tan(a), its derivatives have extrema at fixed angles."""
    angle = np.arctan(x)
    if k == 0:
        return angle
    if k == 1:
        return between_turns(lambda a: np.cos(a) ** 2, angle, (0.0,))
    if k == 2:
        return between_turns(lambda a: -np.sin(a) * np.cos(a) ** 3, angle, (-np.pi / 6, np.pi / 6))
    return between_turns(lambda a: (4 * np.sin(a) ** 2 - 1) * np.cos(a) ** 4 / 3, angle, (-np.pi / 4, 0.0, np.pi / 4))


@_composed
def asin(x: Range, k: int) -> Range:
    """Return the arcsine; with P = 1 - x^2 its coefficients are P^(-1/2), x P^(-3/2)/2, (1 + 2 x^2) P^(-5/2)/6."""
    inside = np.clip(x, -1.0, 1.0)
    squared = power_range(inside, 2)
    P = 1.0 - squared[::-1]
    if k == 0:
        return np.where((x[1] < -1) | (x[0] > 1), np.nan, np.arcsin(inside))
    if k == 1:
        return real_power_range(P, -0.5)
    if k == 2:
        return product(inside / 2, real_power_range(P, -1.5))
    return product((1 + 2 * squared) / 6, real_power_range(P, -2.5))


def _at_ends(z: Range, inner: Range) -> Range:
    """Return the range of a derivative that is zero outside [0, 1] and jumps at both ends."""
    beyond = (z[1] <= 0) | (z[0] >= 1)
    return np.where(beyond, 0.0, np.where((z[0] < 0) | (z[1] > 1), hull(inner, np.zeros_like(inner)), inner))


@_composed
def _cubic_ramp(z: Range, k: int) -> Range:
    """Return z^2 (3 - 2 z) clipped to [0, 1]; its second derivative jumps at both ends."""
    inside = np.clip(z, 0.0, 1.0)
    if k == 0:
        return inside**2 * (3 - 2 * inside)
    if k == 1:
        return between_turns(lambda y: 6 * y * (1 - y), inside, (0.5,))
    if k == 2:
        return _at_ends(z, 3 - 6 * inside[::-1])
    within = (z[0] >= 0) & (z[1] <= 1)
    return _at_ends(z, np.where(within, -2.0, EVERYWHERE))


@_composed
def _quintic_ramp(z: Range, k: int) -> Range:
    """Return z^3 (10 - 15 z + 6 z^2) clipped to [0, 1]; its third derivative jumps at both ends."""
    inside = np.clip(z, 0.0, 1.0)
    turn = np.sqrt(3) / 6
    if k == 0:
        return inside**3 * (10 - 15 * inside + 6 * inside**2)
    if k == 1:
        return between_turns(lambda y: 30 * (y * (1 - y)) ** 2, inside, (0.5,))
    if k == 2:
        return between_turns(lambda y: 30 * y * (1 - y) * (1 - 2 * y), inside, (0.5 - turn, 0.5 + turn))
    return _at_ends(z, between_turns(lambda y: 10 * (1 - 6 * y + 6 * y * y), inside, (0.5,)))


def _step(value: Callable[..., float], ramp: Callable[[Enclosure], Enclosure]) -> Callable[..., Operand]:
    """Return a ramp from h0 at x0 to h1 at x1; it returns a number if all arguments are numbers."""

    def of(x: Operand, x0: Operand, h0: Operand, x1: Operand, h1: Operand) -> Operand:
        z = (x - x0) / (x1 - x0)
        return h0 + (h1 - h0) * (ramp(z) if isinstance(z, Enclosure) else value(z, 0.0, 0.0, 1.0, 1.0))

    return of


step, step5 = _step(step_value, _cubic_ramp), _step(step5_value, _quintic_ramp)


def tan(x: Enclosure) -> Enclosure:
    """Return the tangent."""
    return sin(x) / cos(x)


def sqrt(x: Enclosure) -> Enclosure:
    """Return the square root."""
    return x**0.5


def acos(x: Enclosure) -> Enclosure:
    """Return the arc cosine."""
    return np.pi / 2 - asin(x)


def _by_derivative(function: FormulaFunction) -> Callable[[Enclosure], Enclosure]:
    """Return the enclosure of a function from the enclosure of its derivative."""
    tree = cache(partial(parse, function.derivative))

    def of(x: Enclosure) -> Enclosure:
        """Return the Taylor coefficients by those of the derivative."""
        low, high = x.value
        own = Enclosure.of_time(low, high, max(x.order - 1, 0))  # x as an independent variable
        names = {"x": own, "pi": np.pi}
        slope = evaluate(tree(), names.__getitem__, FUNCTIONS, np.float64)

        return x.composed(lambda k: slope[k - 1] / k if k else _mean_value(function.array, x.value, slope.value))

    return of


def _mean_value(function: Callable[..., np.ndarray], x: Range, slope: Range) -> Range:
    """Return the range of a function from that of its slope: end values if monotonic, else the mean value form."""
    low, high = x
    middle, reach = function((low + high) / 2), (high - low) / 2 * np.abs(slope).max(axis=0)
    ends = np.sort([function(low), function(high)], axis=0)
    monotonic = (slope[0] >= 0) | (slope[1] <= 0)
    return np.where(monotonic, ends, [middle - reach, middle + reach])


FUNCTIONS: dict[str, Callable[..., object]] = {
    name: globals()[function.enclosure] if function.enclosure else _by_derivative(function)
    for name, function in IN_FORMULAS.items()
}
"""Enclosures of the functions of formulas."""
