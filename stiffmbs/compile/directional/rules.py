"""Differentiation rules of the functions that kernels call.

Each rule takes a call's arguments and their derivatives and returns the call's derivative.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...errors import InputError
from .expressions import ZERO, Part, called, number

Parts = Sequence[Part]
Rule = Callable[[Parts, Parts], Part]
ONE = number(1.0)


def _smooth(slope: Callable[[Part], Part]) -> Rule:
    return lambda arguments, moved: slope(arguments[0]) * moved[0]


def _of(name: str) -> Callable[[Part], Part]:
    return lambda x: called(name, x)


def _atan2(arguments: Parts, moved: Parts) -> Part:
    y, x = arguments[:2]
    return (x * moved[0] - y * moved[1]) / (x * x + y * y)


def _chosen(arguments: Parts, moved: Parts) -> Part:
    return called("chosen", arguments[0], *moved[1:]) if any(moved[1:]) else ZERO


def _extreme(greater: bool) -> Rule:
    def rule(arguments: Parts, moved: Parts) -> Part:
        first, second = arguments if greater else arguments[::-1]
        return _chosen([first - second, *arguments], [ZERO, moved[1], moved[0], moved[0]])

    return rule


def _inside(arguments: Parts, moved: Parts) -> Part:
    return called("inside", *arguments[:3], moved[3]) if moved[3] else ZERO


def _step(name: str) -> Rule:
    def rule(arguments: Parts, moved: Parts) -> Part:
        """Differentiate a step function as `stiffmbs.compile.symbolic.nonsmooth.Step.by_parts`."""
        x, x0, h0, x1, h1, order = arguments
        k, width = order.literal, x1 - x0
        shift = moved[0] + (moved[1] * (x - x1) - moved[3] * (x - x0)) / width
        inner = called(name, x, x0, h0, x1, h1, number(k + 1)) * shift
        if k:
            inner = inner - number(float(k)) * called(name, *arguments) * ((moved[3] - moved[1]) / width)
        levels = called(name, x, x0, moved[2], x1, moved[4], order) if moved[2] or moved[4] else ZERO
        return levels + (called("inside", x, x0, x1, inner) if inner else ZERO)

    return rule


def _spline(arguments: Parts, moved: Parts) -> Part:
    """Differentiate by the argument and by the table values, which ``number_d`` holds next to unchanged arguments."""
    numbers, table, x, order = arguments
    by_numbers = called("spline", moved[0], table, x, order) if moved[0] else ZERO
    if order.literal >= 3:  # the third derivative of a cubic is constant
        return by_numbers
    return by_numbers + called("spline", numbers, table, x, number(order.literal + 1)) * moved[2]


def _rotation_vector(arguments: Parts, moved: Parts) -> Part:
    h, order = arguments
    return called("rotation_vector", h, number(order.literal + 1)) * moved[0]


def _python_call(arguments: Parts, moved: Parts) -> Part:
    address, count, output, by, *given = arguments
    if by.literal >= 0:
        return _refuse(
            moved[4:], "a Python function whose second derivatives are needed, expected a formula in its place"
        )
    slopes = (called("python_call", address, count, output, number(k), *given) for k in range(len(given)))
    return sum((slope * part for slope, part in zip(slopes, moved[4:], strict=True)), ZERO)


def _common_normal(arguments: Parts, moved: Parts) -> Part:
    component, *pose = arguments
    normal = [called("common_normal", number(k), *pose) for k in range(3)]
    slopes = (called("common_normal_slope", component, number(k), *normal, *pose) for k in range(len(pose)))
    return sum((slope * part for slope, part in zip(slopes, moved[1:], strict=True)), ZERO)


def _common_normal_slope(arguments: Parts, moved: Parts) -> Part:
    return _refuse(moved[2:], "a contact of solids whose second derivatives are needed, expected another contact")


def _refuse(moved: Parts, found: str) -> Part:
    """Return zero, or refuse arguments that change."""
    if any(moved):
        raise InputError(f"found {found}")
    return ZERO


def _none(arguments: Parts, moved: Parts) -> Part:
    return ZERO


RULES: dict[str, Rule] = {
    "sin": _smooth(_of("cos")),
    "cos": _smooth(lambda x: -called("sin", x)),
    "tan": _smooth(lambda x: ONE / (called("cos", x) * called("cos", x))),
    "asin": _smooth(lambda x: ONE / called("sqrt", ONE - x * x)),
    "acos": _smooth(lambda x: -(ONE / called("sqrt", ONE - x * x))),
    "atan": _smooth(lambda x: ONE / (ONE + x * x)),
    "sinh": _smooth(_of("cosh")),
    "cosh": _smooth(_of("sinh")),
    "tanh": _smooth(lambda x: ONE - called("tanh", x) * called("tanh", x)),
    "asinh": _smooth(lambda x: ONE / called("sqrt", ONE + x * x)),
    "exp": _smooth(_of("exp")),
    "log": _smooth(lambda x: ONE / x),
    "sqrt": _smooth(lambda x: number(0.5) / called("sqrt", x)),
    "magnitude": _smooth(_of("sign")),
    "abs": _smooth(_of("sign")),
    "atan2": _atan2, "continuous_angle": _atan2, "chosen": _chosen, "inside": _inside,
    "greater": _extreme(True), "less": _extreme(False), "step": _step("step"), "step5": _step("step5"),
    "sign": _none, "copysign": _none, "floor": _none, "int": _none,
    "spline": _spline, "rotation_vector": _rotation_vector, "python_call": _python_call,
    "common_normal": _common_normal, "common_normal_slope": _common_normal_slope,
}  # fmt: skip
"""Rules by name of the kernel function."""
