"""The number that a formula gives, without SymPy."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..units.quantity import FUNCTIONS
from ..units.units import Quantity
from .field import Formula
from .text import FormulaError, evaluate


def formula_value(formula: Formula, node: ast.expr | None = None, **variables: float) -> float:
    """The value of a formula, or of one node of it, that holds neither coordinates nor measures.

    Parameters
    ----------
    formula : Formula
    node : ast.expr, optional
        The part to evaluate; the whole formula by default.
    **variables
        Values of time (``t``) and of the formula's variables, where it uses them.

    Raises
    ------
    FormulaError
        When it divides by zero, overflows, or has no real value.
    """

    def names(name: str) -> Quantity:
        return Quantity(variables[name] if name in variables else formula.values[name])

    tree = formula.tree if node is None else node
    try:
        value = evaluate(tree, names, _FUNCTIONS, lambda n: Quantity(float(n))).value
    except (ArithmeticError, ValueError) as error:
        reason = str(error).removeprefix("found ") if isinstance(error, FormulaError) else "no finite real value"
        raise FormulaError(f"found '{ast.unparse(tree)}' in '{formula.text}', which has {reason}") from None
    if not math.isfinite(value):
        raise FormulaError(f"found '{ast.unparse(tree)}' in '{formula.text}', which has no finite value")
    return float(value)


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


_FUNCTIONS: dict[str, Callable[..., Quantity]] = {
    **FUNCTIONS,
    "step": lambda *a: Quantity(step_value(*(q.value for q in a))),
    "step5": lambda *a: Quantity(step5_value(*(q.value for q in a))),
    "sign": lambda a: Quantity(math.copysign(1.0, a.value)),
    "branch": lambda x, below, at, above: below if x.value < 0 else above if x.value > 0 else at,
}
