"""Functions available in formulas, with all their properties in one entry each.

For a SymPy function of one argument, such as ``asinh``, an entry suffices: SymPy differentiates it, kernels call the C
function of that name, and its interval form follows from its derivative.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any

import numpy as np

from ..did_you_mean import instead_of
from .dimension import Known, Part, alike, of_angle, of_branch, of_first, of_numbers, of_root, of_step, plain_always
from .size import within
from .text import FormulaError, real_power


@dataclass(frozen=True)
class Takes:
    """Number of arguments of a function: exactly `least`, or `least` or more."""

    least: int
    or_more: bool = False

    def __contains__(self, count: int) -> bool:
        return count >= self.least if self.or_more else count == self.least

    def __str__(self) -> str:
        return f"{self.least} or more" if self.or_more else str(self.least)


ONE = Takes(1)
OF_TABLE = ONE
Breakpoints = tuple[tuple[int, int | None], ...]
"""Pairs of arguments whose difference is zero at a breakpoint of the function; None for zero itself."""
EACH: Breakpoints = ((0, -1),)
"""Breakpoints where the first argument, or the one selected before, equals each of the others."""
EVERYWHERE = (-math.inf, math.inf)
Words = Collection[str]
Rule = Callable[[Sequence[Part], ast.expr], Known]
"""Function from the dimensions of the arguments, and the call for messages, to the dimension of the value."""


@dataclass(frozen=True)
class FormulaFunction:
    """Function that formulas may call, with its properties."""

    takes: Takes
    dimension: Rule
    value: Callable[..., float]  # evaluates numbers
    array: Callable[..., Any]  # evaluates NumPy arrays
    # counterpart in equations and kernels: ``sympy.sin``, which has the same name in the C library, or a class or function
    # of `stiffmbs.compile.symbolic.nonsmooth`. Empty for a discontinuous function, which only formulas for output may call.
    symbolic: str = ""
    # interval form in `stiffmbs.compile.inputs.enclosed_functions`; empty if it follows from the derivative
    enclosure: str = ""
    derivative: str = ""  # derivative of a function of x with respect to x, as a formula
    breakpoints: Breakpoints = ()
    domain: tuple[float, float] = EVERYWHERE  # of the argument
    poles: bool = False  # True if it is unbounded within its domain
    intervals: str = ""  # its intervals in `stiffmbs.compile.law_intervals`, which resolve narrow features
    turns: bool = False  # True if it is periodic in its argument
    in_numbers: bool = False  # True if numbers may call it as well as formulas

    @property
    def in_c(self) -> bool:
        """True if kernels call it by its name in the C library."""
        return self.symbolic.startswith("sympy.")


Functions = Mapping[str, FormulaFunction]


def step_value(x: Any, x0: Any, h0: Any, x1: Any, h1: Any) -> Any:
    """Return Adams' STEP for numbers or arrays: from h0 at x0 to h1 at x1 by a cubic with zero slope at both ends."""
    z = np.clip((x - x0) / (x1 - x0), 0.0, 1.0)
    return h0 + (h1 - h0) * z**2 * (3 - 2 * z)


def step5_value(x: Any, x0: Any, h0: Any, x1: Any, h1: Any) -> Any:
    """Return Adams' STEP5 for numbers or arrays: a quintic with zero slope and curvature at both ends."""
    z = np.clip((x - x0) / (x1 - x0), 0.0, 1.0)
    return h0 + (h1 - h0) * z**3 * (10 - 15 * z + 6 * z * z)


def branch_value(x: Any, below: Any, at: Any, above: Any) -> Any:
    """Return one of three values, numbers or arrays, by the sign of the first argument (Adams' IF)."""
    return np.select([np.less(x, 0), np.greater(x, 0)], [below, above], at)


def rounded(x: Any) -> Any:
    """Round to the nearest integer, halves away from zero, as Fortran's ANINT."""
    return np.copysign(np.floor(np.abs(x) + 0.5), x)


def _greatest(*values: Any) -> Any:
    return reduce(np.maximum, values)


def _least(*values: Any) -> Any:
    return reduce(np.minimum, values)


def _sign(x: object) -> object:
    return np.where(np.asarray(x) >= 0, 1.0, -1.0)


def _smooth(value: Callable[[float], float], array: Callable[..., object], **others: Any) -> FormulaFunction:
    """Return the entry of a smooth function of a plain number or an angle."""
    name = value.__name__
    enclosure = "" if "derivative" in others else name
    return FormulaFunction(
        ONE, of_numbers, value, array, symbolic=f"sympy.{name}", enclosure=enclosure, in_numbers=True, **others
    )


FUNCTIONS: dict[str, FormulaFunction] = {
    "sin": _smooth(math.sin, np.sin, turns=True),
    "cos": _smooth(math.cos, np.cos, turns=True),
    "tan": _smooth(math.tan, np.tan, poles=True, turns=True),
    "asin": _smooth(math.asin, np.arcsin, domain=(-1.0, 1.0)),
    "acos": _smooth(math.acos, np.arccos, domain=(-1.0, 1.0)),
    "atan": _smooth(math.atan, np.arctan, intervals="atan"),
    "sinh": _smooth(math.sinh, np.sinh, poles=True, intervals="exp"),
    "cosh": _smooth(math.cosh, np.cosh, poles=True, intervals="exp"),
    "tanh": _smooth(math.tanh, np.tanh, intervals="tanh"),
    "asinh": _smooth(math.asinh, np.arcsinh, derivative="1/sqrt(1 + x^2)"),
    "exp": _smooth(math.exp, np.exp, poles=True, intervals="exp"),
    "log": _smooth(math.log, np.log, domain=(0.0, math.inf)),
    "sqrt": FormulaFunction(
        ONE, of_root, partial(real_power, exponent=0.5), np.sqrt, symbolic="sympy.sqrt", enclosure="sqrt",
        domain=(0.0, math.inf), in_numbers=True,
    ),
    "atan2": FormulaFunction(
        Takes(2), of_angle, math.atan2, np.arctan2, symbolic="sympy.atan2", enclosure="atan2", in_numbers=True
    ),
    "abs": FormulaFunction(
        ONE, of_first, abs, np.abs, symbolic="Magnitude", enclosure="absolute", breakpoints=((0, None),), in_numbers=True
    ),
    "min": FormulaFunction(
        Takes(1, True), alike, lambda *values: min(values), _least, symbolic="less", enclosure="minimum", breakpoints=EACH,
        in_numbers=True,
    ),
    "max": FormulaFunction(
        Takes(1, True), alike, lambda *values: max(values), _greatest, symbolic="greater", enclosure="maximum", breakpoints=EACH,
        in_numbers=True,
    ),
    "sign": FormulaFunction(
        ONE, plain_always, partial(math.copysign, 1.0), _sign, symbolic="Sign", enclosure="sign", breakpoints=((0, None),)
    ),
    "step": FormulaFunction(
        Takes(5), of_step, step_value, step_value, symbolic="step", enclosure="step", breakpoints=((0, 1), (0, 3))
    ),
    "step5": FormulaFunction(
        Takes(5), of_step, step5_value, step5_value, symbolic="step5", enclosure="step5", breakpoints=((0, 1), (0, 3))
    ),
    "branch": FormulaFunction(
        Takes(4), of_branch, branch_value, branch_value, symbolic="Chosen", enclosure="branch", breakpoints=((0, None),)
    ),
    "mod": FormulaFunction(Takes(2), alike, math.fmod, np.fmod),
    "trunc": FormulaFunction(ONE, of_numbers, math.trunc, np.trunc),
    "round": FormulaFunction(ONE, of_numbers, rounded, rounded),
    "floor": FormulaFunction(ONE, of_numbers, math.floor, np.floor),
    "ceil": FormulaFunction(ONE, of_numbers, math.ceil, np.ceil),
}  # fmt: skip
"""``step(x, x0, h0, x1, h1)`` goes from h0 to h1 by a cubic, ``step5`` by a quintic. ``branch(x, below, at, above)`` is
the second, third or fourth argument for x below, at or above zero; ``mod`` has the sign of its first argument."""
IN_NUMBERS = {name: function for name, function in FUNCTIONS.items() if function.in_numbers}
IN_FORMULAS = {name: function for name, function in FUNCTIONS.items() if function.symbolic}


def check_functions(
    tree: ast.expr, known: Functions, *, tables: Words = (), measures: Words = (), listed: Words = ()
) -> None:
    """Refuse calls of unknown functions, and calls with a wrong number of arguments, by a FormulaError.

    `measures`: functions of markers, whose arguments are checked elsewhere. `listed`: names of measures that the
    message lists.
    """
    for node in within(tree):
        match node:
            case ast.Call(ast.Name(name), arguments) if name not in measures:
                if name not in known and name not in tables:
                    names = (*known, *tables, *listed)
                    raise FormulaError(f"found the unknown function '{name}'{instead_of(name, names)}")
                takes = OF_TABLE if name in tables else known[name].takes
                if len(arguments) not in takes:
                    raise FormulaError(f"found {len(arguments)} arguments in '{ast.unparse(node)}', expected {takes}")
