"""The functions that formulas may call, and how many arguments each of them takes."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from .text import FormulaError


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
FUNCTIONS: dict[str, Takes] = {
    **dict.fromkeys(
        ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign"), ONE
    ),
    "atan2": Takes(2), "min": Takes(1, True), "max": Takes(1, True), "step": Takes(5), "step5": Takes(5),
    "branch": Takes(4),
}  # fmt: skip
"""What all formulas may call.  ``step(x, x0, h0, x1, h1)`` goes from h0 to h1 by a cubic, ``step5`` by a quintic;
``branch(x, below, at, above)`` is the second, third or fourth for an x below, at or above zero."""
ROUNDING: dict[str, Takes] = {"mod": Takes(2), **dict.fromkeys(("trunc", "round", "floor", "ceil"), ONE)}
"""What formulas that are only reported may call too: steps, which no integrator could follow."""
OF_TABLE = ONE


def check_functions(
    tree: ast.expr, known: Mapping[str, Takes], measures: Collection[str], listed: Collection[str]
) -> None:
    """Refuse calls of unknown functions, with a list of those that are expected, and calls with too few or too many arguments.

    Parameters
    ----------
    tree : ast.expr
    known : mapping of str to Takes
        The functions by name.
    measures : collection of str
        What is called with markers, which are counted elsewhere.
    listed : collection of str
        The names in the list.

    Raises
    ------
    FormulaError
    """
    for node in ast.walk(tree):
        match node:
            case ast.Call(ast.Name(name), arguments) if name not in measures:
                if name not in known:
                    raise FormulaError(f"found the unknown function '{name}', expected one of {', '.join(listed)}")
                if len(arguments) not in known[name]:
                    raise FormulaError(
                        f"found {len(arguments)} arguments in '{ast.unparse(node)}', expected {known[name]}"
                    )
