"""Numerical value of a formula, without SymPy."""

from __future__ import annotations

import ast
import math

from ..units.quantity import VALUES
from .formula import Formula
from .text import OF_NUMBERS, FormulaError, evaluate


def formula_value(formula: Formula, node: ast.expr | None = None, **variables: float) -> float:
    """Return the value of a formula without coordinates and measures, or of its part `node`, for given variables and time ``t``.

    Raises FormulaError if it divides by zero, overflows, or has no real value.
    """

    def names(name: str) -> float:
        return variables[name] if name in variables else formula.values[name]

    tree = formula.tree if node is None else node
    try:
        value = evaluate(tree, names, VALUES, float, OF_NUMBERS)
    except (ArithmeticError, ValueError) as error:
        reason = str(error).removeprefix("found ") if isinstance(error, FormulaError) else "no finite real value"
        raise FormulaError(f"found '{ast.unparse(tree)}' in '{formula.text}', which has {reason}") from None
    if not math.isfinite(value):
        raise FormulaError(f"found '{ast.unparse(tree)}' in '{formula.text}', which has no finite value")
    return float(value)
