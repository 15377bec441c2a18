"""Nonsmooth functions in equations: each derivative is the slope of what it is the derivative of."""

import numpy as np
import pytest
import sympy as sp

from stiffmbs.compile.machine.native import nonsmooth as breakpoints
from stiffmbs.compile.symbolic.nonsmooth import (
    Chosen,
    Greater,
    Inside,
    Less,
    Magnitude,
    Sign,
    Step,
    Step5,
    greater,
    less,
    step,
    step5,
)

x = sp.Symbol("x", real=True)
NATIVE = {
    kind.__name__: getattr(breakpoints, kind.native)
    for kind in (Chosen, Greater, Inside, Less, Magnitude, Sign, Step, Step5)
}
LAWS = {
    "abs": Magnitude(x**3 - x),
    "max": greater(sp.sin(x), x / 3, 0.2),
    "min": less(sp.sin(x), x / 3, 0.2),
    "step": step(x, -1, 0.2, 2, 0.7),
    "step5": step5(x, -1, 0.2, 2, 0.7),
    "step between moving ends": step(x**2 / 3, sp.cos(x) - 2, sp.sin(x), 2 + x / 7, x**2),
    "step5 between moving ends": step5(x**2 / 3, sp.cos(x) - 2, sp.sin(x), 2 + x / 7, x**2),
    "step of a step": step(step5(x, -1, 0, 2, 1), 0.2, x, 0.9, 2),
    "branch": Chosen(x - 0.5, sp.sin(x), x, x**2),
}
POINTS = (-2.9, -2.17, -1.42, -0.71, -0.43, 0.11, 0.63, 1.27, 1.88, 2.23, 2.9)
"""On all sides of the breakpoints, away from them by more than differences reach."""
H = 1e-3


def function(law):
    return np.vectorize(sp.lambdify(x, law, [NATIVE, "math"]), otypes=[float])


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_each_derivative_is_the_slope_of_the_one_before(law):
    t = np.array(POINTS)
    for _ in range(3):
        f, law = function(law), sp.diff(law, x)
        slope = (8 * (f(t + H) - f(t - H)) - f(t + 2 * H) + f(t - 2 * H)) / (12 * H)
        np.testing.assert_allclose(function(law)(t), slope, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize(
    ("ramp", "rise"), [(breakpoints.step, [-2, 3, 0, 0]), (breakpoints.step5, [6, -15, 10, 0, 0, 0])]
)
def test_a_ramp_and_its_derivatives_are_those_of_its_polynomial(ramp, rise):
    t = np.array(POINTS)
    z = (t + 1) / 3
    for order in range(7):
        level = np.where(z < 0, 0.2, 0.7) if order == 0 else 0.0
        inside = (0.2 if order == 0 else 0.0) + 0.5 * np.polyval(np.polyder(rise, order), z) / 3**order
        found = [ramp(value, -1.0, 0.2, 2.0, 0.7, order) for value in t]
        np.testing.assert_allclose(found, np.where((z < 0) | (z > 1), level, inside), rtol=1e-13, atol=1e-13)


def test_the_greater_and_the_less_of_two():
    t = np.array(POINTS)
    np.testing.assert_array_equal(function(Greater(sp.sin(x), 0.2))(t), np.maximum(np.sin(t), 0.2))
    np.testing.assert_array_equal(function(Less(sp.sin(x), 0.2))(t), np.minimum(np.sin(t), 0.2))
    assert (Greater(2, 3), Less(2, 3), Greater(x, x), Less(x, x)) == (3, 2, x, x)
