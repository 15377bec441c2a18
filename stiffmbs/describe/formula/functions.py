"""The functions that formulas may call: how many arguments each takes, its value, and how dimensions go through it."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .dimension import PLAIN, Known, Part, alike, plain_number, power
from .text import FormulaError, real_power


@dataclass(frozen=True)
class Takes:
    """How many arguments a function takes: `least`, or from there on as many as one likes."""

    least: int
    or_more: bool = False

    def __contains__(self, count: int) -> bool:
        return count >= self.least if self.or_more else count == self.least

    def __str__(self) -> str:
        return f"{self.least} or more" if self.or_more else str(self.least)


ONE = Takes(1)
OF_TABLE = ONE
Rule = Callable[[Sequence[Part], ast.expr], Known]
"""From the dimensions of a function's arguments, and the call for messages, to that of its value."""


@dataclass(frozen=True)
class FormulaFunction:
    """A function of formulas.

    Attributes
    ----------
    takes : Takes
    dimension : Rule
    value : callable
        Of plain numbers.
    in_numbers : bool
        Whether numbers may call it, and not only formulas.
    only_reported : bool
        Whether only formulas that are reported may call it: its value jumps, and no integrator could follow.
    """

    takes: Takes
    dimension: Rule
    value: Callable[..., float]
    in_numbers: bool = True
    only_reported: bool = False


def _of_numbers(parts: Sequence[Part], where: ast.expr) -> Known:
    """A plain number from plain numbers or angles."""
    for part in parts:
        plain_number(part)
    return PLAIN


def _of_first(parts: Sequence[Part], where: ast.expr) -> Known:
    return parts[0][0]


def _root(parts: Sequence[Part], where: ast.expr) -> Known:
    return power(parts[0][0], (PLAIN, where), 0.5)


def _angle(parts: Sequence[Part], where: ast.expr) -> Known:
    """An angle from lengths, or from anything alike."""
    found = alike(parts, where)
    return Known(PLAIN.exponents, found.stated, found.fits_all)


def _of_any(parts: Sequence[Part], where: ast.expr) -> Known:
    return PLAIN


def _step(parts: Sequence[Part], where: ast.expr) -> Known:
    """STEP(x, x0, h0, x1, h1): x0 and x1 are like x; h0 like h1."""
    x, x0, h0, x1, h1 = parts
    alike((x, x0, x1), where)
    return alike((h0, h1), where)


def _branch(parts: Sequence[Part], where: ast.expr) -> Known:
    return alike(parts[1:], where)


def step_value(x: Any, x0: Any, h0: Any, x1: Any, h1: Any) -> Any:
    """Adams' STEP, of numbers or arrays: from h0 at x0 to h1 at x1 by a cubic that is flat at both ends."""
    z = np.clip((x - x0) / (x1 - x0), 0.0, 1.0)
    return h0 + (h1 - h0) * z**2 * (3 - 2 * z)


def step5_value(x: Any, x0: Any, h0: Any, x1: Any, h1: Any) -> Any:
    """Adams' STEP5, of numbers or arrays: from h0 at x0 to h1 at x1 by a quintic without slope and curvature at both ends."""
    z = np.clip((x - x0) / (x1 - x0), 0.0, 1.0)
    return h0 + (h1 - h0) * z**3 * (10 - 15 * z + 6 * z * z)


def branch_value(x: Any, below: Any, at: Any, above: Any) -> Any:
    """One of three, of numbers or arrays, by the sign of the first (Adams' IF)."""
    return np.select([np.less(x, 0), np.greater(x, 0)], [below, above], at)


def _smooth(value: Callable[[float], float]) -> FormulaFunction:
    """A function of a plain number or an angle."""
    return FormulaFunction(ONE, _of_numbers, value)


FUNCTIONS: dict[str, FormulaFunction] = {
    **{f.__name__: _smooth(f) for f in (
        math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.sinh, math.cosh, math.tanh, math.exp, math.log,
    )},
    "sqrt": FormulaFunction(ONE, _root, partial(real_power, exponent=0.5)),
    "atan2": FormulaFunction(Takes(2), _angle, math.atan2),
    "abs": FormulaFunction(ONE, _of_first, abs),
    "min": FormulaFunction(Takes(1, True), alike, lambda *values: min(values)),
    "max": FormulaFunction(Takes(1, True), alike, lambda *values: max(values)),
    "sign": FormulaFunction(ONE, _of_any, partial(math.copysign, 1.0), in_numbers=False),
    "step": FormulaFunction(Takes(5), _step, step_value, in_numbers=False),
    "step5": FormulaFunction(Takes(5), _step, step5_value, in_numbers=False),
    "branch": FormulaFunction(Takes(4), _branch, branch_value, in_numbers=False),
    "mod": FormulaFunction(Takes(2), alike, math.fmod, in_numbers=False, only_reported=True),
    **{name: FormulaFunction(ONE, _of_numbers, value, in_numbers=False, only_reported=True) for name, value in (
        ("trunc", math.trunc), ("round", round), ("floor", math.floor), ("ceil", math.ceil),
    )},
}  # fmt: skip
"""``step(x, x0, h0, x1, h1)`` goes from h0 to h1 by a cubic, ``step5`` by a quintic; ``branch(x, below, at, above)`` is the
second, third or fourth for an x below, at or above zero; ``mod`` has the sign of its first argument."""
IN_NUMBERS = {name: function for name, function in FUNCTIONS.items() if function.in_numbers}
IN_FORMULAS = {name: function for name, function in FUNCTIONS.items() if not function.only_reported}


def check_functions(
    tree: ast.expr,
    known: Mapping[str, FormulaFunction],
    *,
    tables: Collection[str] = (),
    measures: Collection[str] = (),
    listed: Collection[str] = (),
) -> None:
    """Refuse calls of unknown functions, with a list of those that are expected, and calls with too few or too many arguments.

    Parameters
    ----------
    tree : ast.expr
    known : mapping of str to FormulaFunction
    tables : collection of str
        Tables that may be called.
    measures : collection of str
        What is called with markers, which are counted elsewhere.
    listed : collection of str
        Measures and the like in the list of what is expected.

    Raises
    ------
    FormulaError
    """
    for node in ast.walk(tree):
        match node:
            case ast.Call(ast.Name(name), arguments) if name not in measures:
                if name not in known and name not in tables:
                    expected = ", ".join((*known, *tables, *listed))
                    raise FormulaError(f"found the unknown function '{name}', expected one of {expected}")
                takes = OF_TABLE if name in tables else known[name].takes
                if len(arguments) not in takes:
                    raise FormulaError(f"found {len(arguments)} arguments in '{ast.unparse(node)}', expected {takes}")
