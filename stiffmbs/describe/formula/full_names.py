"""Full names of bodies, markers and joints in formulas: within a part ``arm.x`` becomes ``front.left.arm.x``."""

from __future__ import annotations

import ast
from collections.abc import Container

from ..parts.names import GROUND, Names
from .text import UNIT, as_written


def with_full_names(tree: ast.expr, names: Names, takers: Container[str]) -> ast.expr:
    """Return a formula's tree with full names; the body of a coordinate or marker is a single node, also with dots.

    Parameters
    ----------
    tree : ast.expr
        From `stiffmbs.describe.formula.text.parse`.
    names : Names
    takers : container of str
        Functions whose arguments are names of markers, joints or forces.
    """
    return _FullNames(names, takers).visit(tree) if names.dotted else tree


def text_in_full(text: str, tree: ast.expr, names: Names) -> str:
    """Return the text of a formula for messages, with full names if it is within a part."""
    return as_written(tree) if names.local else text


class _FullNames(ast.NodeTransformer):
    def __init__(self, names: Names, takers: Container[str]) -> None:
        self.names, self.takers = names, takers

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        text = ast.unparse(node)
        return node if text.startswith(f"{UNIT}.") else _owned(*_halves(self.names.full(text)))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        taking = isinstance(node.func, ast.Name) and node.func.id in self.takers
        seen = self._taken if taking else self.visit
        return ast.Call(node.func, [seen(argument) for argument in node.args], [])

    def _taken(self, node: ast.expr) -> ast.expr:
        if not isinstance(node, ast.Name | ast.Attribute):
            return node
        text = self.names.full(ast.unparse(node))
        body, marker = self.names.body_and_marker(text)
        known = body in self.names.bodies or body == GROUND
        return _owned(body, marker) if known else _owned(*_halves(text))


def _halves(text: str) -> tuple[str, str]:
    owner, _, last = text.rpartition(".")
    return (owner, last) if owner else (last, "")


def _owned(owner: str, name: str) -> ast.expr:
    return ast.Attribute(ast.Name(owner), name) if name else ast.Name(owner)
