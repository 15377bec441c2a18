"""Full names of bodies, markers, joints and states in formulas: within a part ``arm.x`` becomes ``front.left.arm.x``."""

from __future__ import annotations

import ast
from collections.abc import Container

from ..names import GROUND, Names
from .text import UNIT, as_written


def with_full_names(tree: ast.expr, names: Names, takers: Container[str], own: Container[str] = ()) -> ast.expr:
    """Return a formula's tree with full names; a state, and the body of a coordinate or marker, is one node, also with dots.

    `takers`: functions whose arguments are names of markers, joints or forces. `own`: names defined by the formula's
    field.
    """
    return _FullNames(names, takers, own).visit(tree) if names.dotted or names.states else tree


def text_in_full(text: str, tree: ast.expr, names: Names) -> str:
    """Return the text of a formula for messages, with full names if it is within a part."""
    return as_written(tree) if names.local else text


class _FullNames(ast.NodeTransformer):
    def __init__(self, names: Names, takers: Container[str], own: Container[str]) -> None:
        self._names, self._takers, self._own = names, takers, own

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """Return a state by its full name, and any other name as it is."""
        full = self._names.full(node.id)
        return ast.Name(full) if full in self._names.states and node.id not in self._own else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """Return a state, or a coordinate of a body by its full name."""
        text = ast.unparse(node)
        if text.startswith(f"{UNIT}."):
            return node
        full = self._names.full(text)
        if full in self._names.states:
            return ast.Name(full)
        return _owned(*_halves(full)) if self._names.dotted else node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """Return a call with full names in its arguments."""
        taking = isinstance(node.func, ast.Name) and node.func.id in self._takers
        return ast.Call(node.func, [self._taken(each) if taking else self.visit(each) for each in node.args], [])

    def _taken(self, node: ast.expr) -> ast.expr:
        if not isinstance(node, ast.Name | ast.Attribute) or not self._names.dotted:
            return node
        text = ast.unparse(node)
        body, marker = self._names.body_and_marker(text)
        known = body in self._names.bodies or body == GROUND
        return _owned(body, marker) if known else _owned(*_halves(self._names.full(text)))


def _halves(text: str) -> tuple[str, str]:
    owner, _, last = text.rpartition(".")
    return (owner, last) if owner else (last, "")


def _owned(owner: str, name: str) -> ast.expr:
    return ast.Attribute(ast.Name(owner), name) if name else ast.Name(owner)
