"""Functions of Python and its module `math` in the language."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import Any

from ....reading.formula.functions import FUNCTIONS as FORMULA_FUNCTIONS
from .arithmetic import compared, negated, number, selected
from .code import Code
from .values import Builtin, Operand, Value, builtin

INTRINSICS = ("sqrt", "sin", "cos", "exp", "log", "copysign", "floor")
"""LLVM intrinsics; other functions are called in the C library of the process."""
OF_THE_LIBRARY = tuple(name for name, function in FORMULA_FUNCTIONS.items() if function.in_c and name not in INTRINSICS)


def _library(symbol: str) -> Builtin:
    def lower(code: Code, *arguments: Operand) -> Value:
        return code.unit.called_library(code, symbol, *map(number, arguments))

    return Builtin(lower)


@builtin
def absolute(code: Code, operand: Operand) -> Value:
    """Translate abs(x)."""
    x = number(operand)
    if x.kind == "float":
        return code.unit.called_library(code, "llvm.fabs.f64", x)
    return selected(code, compared(code, ast.Lt(), x, Value("int", "0")), negated(code, x), code.integer(x))


def _extreme(comparison: ast.cmpop) -> Builtin:
    def lower(code: Code, *operands: Operand) -> Value:
        best = number(operands[0])
        for operand in map(number, operands[1:]):
            best = selected(code, compared(code, comparison, operand, best), operand, best)
        return best

    return Builtin(lower)


@builtin
def to_float(code: Code, operand: Operand) -> Value:
    """Translate float(x)."""
    return code.converted(operand, "float")


@builtin
def to_int(code: Code, operand: Operand) -> Value:
    """Translate int(x): truncation towards zero."""
    x = number(operand)
    return code.put_value("int", f"fptosi {x.typed} to i64") if x.kind == "float" else code.integer(x)


@builtin
def is_finite(code: Code, operand: Operand) -> Value:
    """Translate isfinite(x)."""
    size = code.unit.called_library(code, "llvm.fabs.f64", number(operand))
    return compared(code, ast.Lt(), size, Value("float", "0x7FF0000000000000"))


FUNCTIONS: dict[Callable[..., Any], Builtin] = {
    abs: absolute, max: _extreme(ast.Gt()), min: _extreme(ast.Lt()), float: to_float, int: to_int,
    math.isfinite: is_finite, math.fabs: absolute,
    **{getattr(math, name): _library(f"llvm.{name}.f64") for name in INTRINSICS},
    **{getattr(math, name): _library(name) for name in OF_THE_LIBRARY},
}  # fmt: skip
