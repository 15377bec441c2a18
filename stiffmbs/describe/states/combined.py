"""Weighted sums of formulas and states."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import replace

from ..formula.dimension import UNKNOWN
from ..formula.formula import Formula
from ..table import Table

Weighted = tuple[float, Formula | str]
"""Weight, and the formula or state that it multiplies."""


def combined(parts: Sequence[Weighted], *formulas: Formula) -> Formula:
    """Return a weighted sum of formulas and states.

    Parameters
    ----------
    parts : sequence of (float, Formula or str)
    *formulas : Formula
        Formulas among the parts, and others whose parameters the sum keeps.
    """
    kept = [(weight, part) for weight, part in parts if weight]
    terms = [_times(weight, ast.Name(part) if isinstance(part, str) else part.tree) for weight, part in kept]
    tree: ast.expr = ast.Constant(0.0)
    for k, term in enumerate(terms):
        tree = ast.BinOp(tree, ast.Add(), term) if k else term
    states = [name for formula in formulas for name in formula.states]
    states += [part for _, part in parts if isinstance(part, str)]
    values: dict[str, float] = {}
    tables: dict[str, Table] = {}
    for formula in formulas:
        values |= formula.values
        tables |= dict(formula.tables)
    return replace(
        formulas[0], text=ast.unparse(ast.fix_missing_locations(tree)), tree=tree, values=values, tables=tables,
        dimension=UNKNOWN, states=tuple(dict.fromkeys(states)), among_variables=False,
    )  # fmt: skip


def _times(weight: float, tree: ast.expr) -> ast.expr:
    return tree if weight == 1.0 else ast.BinOp(ast.Constant(float(weight)), ast.Mult(), tree)
