"""Names of states in formulas, such as ``lag`` or ``front.left.lag``."""

from __future__ import annotations

import ast
from collections.abc import Container

from ..parts.names import Names
from .text import UNIT


def with_states(tree: ast.expr, names: Names, own: Container[str], takers: Container[str]) -> ast.expr:
    """Return a formula's tree in which each state is a single name, also with dots.

    Parameters
    ----------
    tree : ast.expr
        From `stiffmbs.describe.formula.full_names.with_full_names`.
    names : Names
    own : container of str
        Names defined by the formula's field.
    takers : container of str
        Functions whose arguments are names of markers, joints or forces.
    """
    return _States(names, own, takers).visit(tree) if names.states else tree


class _States(ast.NodeTransformer):
    def __init__(self, names: Names, own: Container[str], takers: Container[str]) -> None:
        self._names, self._own, self._takers = names, own, takers

    def visit_Name(self, node: ast.Name) -> ast.expr:
        full = self._names.full(node.id)
        return ast.Name(full) if full in self._names.states and node.id not in self._own else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        text = ast.unparse(node)
        full = text if text.startswith(f"{UNIT}.") else self._names.full(text)
        return ast.Name(full) if full in self._names.states else node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if isinstance(node.func, ast.Name) and node.func.id in self._takers:
            return node
        return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])
