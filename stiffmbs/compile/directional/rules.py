"""Differentiation rules of the functions that kernels call.

Each rule takes a call's arguments and their derivatives (None for zero) and returns the call's derivative.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence

from ...errors import InputError
from .expressions import (
    Part,
    added,
    called,
    difference,
    divided,
    literal,
    multiplied,
    negated,
    number,
    squared,
    whole,
)

Rule = Callable[[Sequence[ast.expr], Sequence[Part]], Part]
HIGHEST_OF_SPLINE = 3
"""Highest non-zero derivative of a cubic table."""


def _smooth(slope: Callable[[ast.expr], ast.expr]) -> Rule:
    def rule(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
        return None if moved[0] is None else multiplied(slope(arguments[0]), moved[0])

    return rule


def _one_over(x: Part) -> ast.expr:
    return whole(divided(number(1.0), x))


def _atan2(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    y, x = arguments
    turned = difference(multiplied(x, moved[0]), multiplied(y, moved[1]))
    return divided(turned, added(squared(x), squared(y)))


def _continuous_angle(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    return _atan2(arguments[:2], moved[:2])


def _chosen(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    if all(part is None for part in moved[1:]):
        return None
    return called("chosen", arguments[0], *map(whole, moved[1:]))


def _extreme(direction: int) -> Rule:
    def rule(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
        first, second = arguments if direction > 0 else arguments[::-1]
        return _chosen([whole(difference(first, second)), *arguments], [None, moved[1], moved[0], moved[0]])

    return rule


def _inside(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    return None if moved[3] is None else called("inside", *arguments[:3], moved[3])


def _step(name: str) -> Rule:
    def rule(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
        """Differentiate a step function as `stiffmbs.compile.symbolic.nonsmooth.Step.by_parts`."""
        x, x0, h0, x1, h1, order = arguments
        k = literal(order)
        width = difference(x1, x0)
        shift = added(
            moved[0],
            divided(
                difference(multiplied(moved[1], difference(x, x1)), multiplied(moved[3], difference(x, x0))), width
            ),
        )
        inner = multiplied(called(name, x, x0, h0, x1, h1, number(k + 1)), shift)
        if k:
            wider = divided(difference(moved[3], moved[1]), width)
            inner = difference(inner, multiplied(multiplied(number(float(k)), called(name, *arguments)), wider))
        levels = None
        if moved[2] is not None or moved[4] is not None:
            levels = called(name, x, x0, whole(moved[2]), x1, whole(moved[4]), order)
        return added(levels, None if inner is None else called("inside", x, x0, x1, inner))

    return rule


def _spline(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    """Differentiate by the argument and by the table values, which ``number_d`` holds next to unchanged arguments."""
    number_of_table, table, x, order = arguments
    by_numbers = None if moved[0] is None else called("spline", moved[0], table, x, order)
    if moved[2] is None or literal(order) >= HIGHEST_OF_SPLINE:
        return by_numbers
    return added(
        by_numbers, multiplied(called("spline", number_of_table, table, x, number(literal(order) + 1)), moved[2])
    )


def _rotation_vector(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    h, order = arguments
    return multiplied(called("rotation_vector", h, number(literal(order) + 1)), moved[0])


def _python_call(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    address, count, output, by, *given = arguments
    if literal(by) >= 0:
        if all(part is None for part in moved[4:]):
            return None
        raise InputError("found a Python function whose second derivatives are needed, expected a formula in its place")
    return added(*(
        multiplied(called("python_call", address, count, output, number(k), *given), part)
        for k, part in enumerate(moved[4:])
    ))  # fmt: skip


def _common_normal(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    component, *pose = arguments
    if all(part is None for part in moved[1:]):
        return None
    normal = [called("common_normal", number(k), *pose) for k in range(3)]
    return added(*(
        multiplied(called("common_normal_slope", component, number(k), *normal, *pose), part)
        for k, part in enumerate(moved[1:])
    ))  # fmt: skip


def _common_normal_slope(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    if all(part is None for part in moved[2:]):
        return None
    raise InputError("found a contact of solids whose second derivatives are needed, expected another contact")


def _none(arguments: Sequence[ast.expr], moved: Sequence[Part]) -> Part:
    return None


RULES: dict[str, Rule] = {
    "sin": _smooth(lambda x: called("cos", x)),
    "cos": _smooth(lambda x: whole(negated(called("sin", x)))),
    "tan": _smooth(lambda x: _one_over(squared(called("cos", x)))),
    "asin": _smooth(lambda x: _one_over(called("sqrt", whole(difference(number(1.0), squared(x)))))),
    "acos": _smooth(lambda x: whole(negated(_one_over(called("sqrt", whole(difference(number(1.0), squared(x)))))))),
    "atan": _smooth(lambda x: _one_over(added(number(1.0), squared(x)))),
    "sinh": _smooth(lambda x: called("cosh", x)),
    "cosh": _smooth(lambda x: called("sinh", x)),
    "tanh": _smooth(lambda x: whole(difference(number(1.0), squared(called("tanh", x))))),
    "asinh": _smooth(lambda x: _one_over(called("sqrt", whole(added(number(1.0), squared(x)))))),
    "exp": _smooth(lambda x: called("exp", x)),
    "log": _smooth(_one_over),
    "sqrt": _smooth(lambda x: whole(divided(number(0.5), called("sqrt", x)))),
    "magnitude": _smooth(lambda x: called("sign", x)),
    "abs": _smooth(lambda x: called("sign", x)),
    "atan2": _atan2, "continuous_angle": _continuous_angle, "chosen": _chosen, "inside": _inside,
    "greater": _extreme(1), "less": _extreme(-1), "step": _step("step"), "step5": _step("step5"),
    "sign": _none, "copysign": _none, "floor": _none, "int": _none,
    "spline": _spline, "rotation_vector": _rotation_vector, "python_call": _python_call,
    "common_normal": _common_normal, "common_normal_slope": _common_normal_slope,
}  # fmt: skip
"""Rules by name of the kernel function."""
