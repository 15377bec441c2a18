"""Enclosures of the functions of formulas."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from math import factorial

import numpy as np

from ...reading.formula.functions import IN_FORMULAS, FormulaFunction, step5_value, step_value
from ...reading.formula.text import evaluate, parse
from .enclosure import (  # noqa: F401 (the table of functions names them)
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


def _turned(phase: float) -> Callable[[Enclosure], Enclosure]:
    """Return the cosine wave with its maximum at `phase`; each derivative shifts it by a quarter period."""
    return lambda x: x.composed(lambda k: wave(x.value, phase - k * np.pi / 2) / factorial(k))


sin, cos = _turned(np.pi / 2), _turned(0.0)


def _hyperbolic(even: bool) -> Callable[[Enclosure], Enclosure]:
    """Return cosh or sinh, which are each other's derivatives."""

    def of(x: Enclosure) -> Enclosure:
        """Return the enclosure of the function at an enclosed argument."""

        def outer(k: int) -> Range:
            """Return the range of the k-th Taylor coefficient of the function."""
            rising = even != (k % 2 == 0)
            return (np.sinh(x.value) if rising else between_turns(np.cosh, x.value, (0.0,))) / factorial(k)

        return x.composed(outer)

    return of


sinh, cosh = _hyperbolic(False), _hyperbolic(True)


def tanh(x: Enclosure) -> Enclosure:
    """Return tanh: T' = 1 - T^2, T''/2 = -T T', T'''/6 = -T' (1 - 3 T^2)/3."""
    T = np.tanh(x.value)
    rate = between_turns(lambda z: 1 / np.cosh(z) ** 2, x.value, (0.0,))

    def outer(k: int) -> Range:
        """Return the range of the k-th Taylor coefficient of the function."""
        third = (3 * power_range(T, 2) - 1) / 3
        return (T, rate, -product(T, rate)[::-1], product(rate, third))[k]

    return x.composed(outer)


def atan(x: Enclosure) -> Enclosure:
    """Return the arctangent: with x = tan(a), its derivatives have extrema at fixed angles."""
    angle = np.arctan(x.value)

    def outer(k: int) -> Range:
        """Return the range of the k-th Taylor coefficient of the function."""
        return (
            lambda: angle,
            lambda: between_turns(lambda a: np.cos(a) ** 2, angle, (0.0,)),
            lambda: between_turns(lambda a: -np.sin(a) * np.cos(a) ** 3, angle, (-np.pi / 6, np.pi / 6)),
            lambda: between_turns(
                lambda a: (4 * np.sin(a) ** 2 - 1) * np.cos(a) ** 4 / 3, angle, (-np.pi / 4, 0.0, np.pi / 4)
            ),
        )[k]()

    return x.composed(outer)


def asin(x: Enclosure) -> Enclosure:
    """Return the arcsine; with P = 1 - x^2 its coefficients are P^(-1/2), x P^(-3/2)/2, (1 + 2 x^2) P^(-5/2)/6."""
    inside = np.clip(x.value, -1.0, 1.0)
    squared = power_range(inside, 2)
    P = 1.0 - squared[::-1]

    def outer(k: int) -> Range:
        """Return the range of the k-th Taylor coefficient of the function."""
        if k == 0:
            return np.where((x.value[1] < -1) | (x.value[0] > 1), np.nan, np.arcsin(inside))
        if k == 1:
            return real_power_range(P, -0.5)
        if k == 2:
            return product(inside / 2, real_power_range(P, -1.5))
        return product((1 + 2 * squared) / 6, real_power_range(P, -2.5))

    return x.composed(outer)


def _step(
    x: Operand,
    x0: Operand,
    h0: Operand,
    x1: Operand,
    h1: Operand,
    value: Callable[..., float],
    ramp: Callable[..., Enclosure],
) -> Operand:
    z = (x - x0) / (x1 - x0)
    return h0 + (h1 - h0) * (ramp(z) if isinstance(z, Enclosure) else value(z, 0.0, 0.0, 1.0, 1.0))


def _within(z: Range) -> tuple[Range, np.ndarray, np.ndarray]:
    """Return the part of a range in [0, 1], and masks of ranges that contain 0 or 1 and of ranges outside."""
    inside = np.clip(z, 0.0, 1.0)
    beyond = (z[1] <= 0) | (z[0] >= 1)
    return inside, ((z[0] < 0) | (z[1] > 1)) & ~beyond, beyond


def _cubic_ramp(z: Enclosure) -> Enclosure:
    """Return z^2 (3 - 2 z) clipped to [0, 1]; its second derivative jumps at both ends."""
    inside, crosses, beyond = _within(z.value)

    def outer(k: int) -> Range:
        """Return the range of the k-th Taylor coefficient of the function."""
        if k == 0:
            return inside**2 * (3 - 2 * inside)
        if k == 1:
            return between_turns(lambda y: 6 * y * (1 - y), inside, (0.5,))
        curved = 3 - 6 * inside[::-1] if k == 2 else np.where(crosses, EVERYWHERE, -2.0)
        return np.where(beyond, 0.0, np.where(crosses, hull(curved, np.zeros_like(inside)), curved))

    return z.composed(outer)


def _quintic_ramp(z: Enclosure) -> Enclosure:
    """Return z^3 (10 - 15 z + 6 z^2) clipped to [0, 1]; its third derivative jumps at both ends."""
    inside, crosses, beyond = _within(z.value)
    turn = np.sqrt(3) / 6

    def outer(k: int) -> Range:
        """Return the range of the k-th Taylor coefficient of the function."""
        if k == 0:
            return inside**3 * (10 - 15 * inside + 6 * inside**2)
        if k == 1:
            return between_turns(lambda y: 30 * (y * (1 - y)) ** 2, inside, (0.5,))
        if k == 2:
            return between_turns(lambda y: 30 * y * (1 - y) * (1 - 2 * y), inside, (0.5 - turn, 0.5 + turn))
        bent = between_turns(lambda y: 10 * (1 - 6 * y + 6 * y * y), inside, (0.5,))
        return np.where(beyond, 0.0, np.where(crosses, hull(bent, np.zeros_like(inside)), bent))

    return z.composed(outer)


def step(x: Operand, x0: Operand, h0: Operand, x1: Operand, h1: Operand) -> Operand:
    """Return Adams' STEP: a cubic from h0 at x0 to h1 at x1 with zero end slopes.

    Returns a number if all arguments are numbers.
    """
    return _step(x, x0, h0, x1, h1, step_value, _cubic_ramp)


def step5(x: Operand, x0: Operand, h0: Operand, x1: Operand, h1: Operand) -> Operand:
    """Return Adams' STEP5: a quintic with zero end slopes and curvatures, otherwise as `step`."""
    return _step(x, x0, h0, x1, h1, step5_value, _quintic_ramp)


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
        """Return the enclosure of the function at an enclosed argument."""
        low, high = x.value
        own = Enclosure.of_time(low, high, max(x.order - 1, 0))  # x as an independent variable
        names = {"x": own, "pi": np.pi}
        slope = evaluate(tree(), names.__getitem__, FUNCTIONS, np.float64)

        def outer(k: int) -> Range:
            """Return the range of the k-th Taylor coefficient of the function."""
            return _mean_value(function.array, x.value, slope.value) if k == 0 else slope[k - 1] / k

        return x.composed(outer)

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
