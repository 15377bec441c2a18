"""Substitute names in the formulas of a scene."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator
from typing import Any

from stiffmbs.reading.formula.nodes import TIME, is_measure, is_reaction
from stiffmbs.reading.formula.text import as_written, parse

from ..random_scenes.draft import Content

Replace = Callable[[ast.expr], str | None]
"""Return the substitute of a name, coordinate, measure or reaction, or None if it is unchanged."""


def replaced(text: Any, replace: Replace) -> Any:
    """Return a formula with substitutions; a number is unchanged."""
    if not isinstance(text, str):
        return text
    return as_written(_Replaced(replace).visit(copy.deepcopy(parse(text))))


class _Replaced(ast.NodeTransformer):
    def __init__(self, replace: Replace) -> None:
        self._replace = replace

    def _visited(self, node: ast.expr) -> ast.AST:
        text = self._replace(node)
        return node if text is None else parse(text)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Substitute time, a variable or a state."""
        return self._visited(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Substitute a coordinate or a channel."""
        return self._visited(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Substitute a measure or reaction, or the arguments of a function."""
        if is_measure(node) or is_reaction(node) or _called(node).startswith("acc"):
            return self._visited(node)
        return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])


def _called(node: ast.Call) -> str:
    assert isinstance(node.func, ast.Name)
    return node.func.id


def call_of(node: ast.expr) -> tuple[str, list[str]] | None:
    """Return the name and the arguments of a measure or reaction, or None for any other node."""
    if isinstance(node, ast.Call):
        return _called(node), [ast.unparse(argument) for argument in node.args]
    return None


def coordinate_of(node: ast.expr) -> tuple[str, str] | None:
    """Return the owner and the name of a coordinate such as ``b.vx``, or None for any other node."""
    if isinstance(node, ast.Attribute):
        return ast.unparse(node.value), node.attr
    return None


def is_time(node: ast.expr) -> bool:
    """Return True for t."""
    return isinstance(node, ast.Name) and node.id == TIME


def with_other_formulas(content: Content, replace: Replace) -> Content:
    """Return a scene's states and requests with substituted formulas."""
    found = dict(content)
    if "states" in content:
        found["states"] = {name: dict(_state(entry, replace)) for name, entry in content["states"].items()}
    if "requests" in content:
        found["requests"] = {name: replaced(text, replace) for name, text in content["requests"].items()}
    return found


FORMULAS = ("rate", "zero", "update", "input", "setpoint")
"""Keys of states that hold formulas."""


def _state(entry: Content, replace: Replace) -> Iterator[tuple[str, Any]]:
    for key, value in entry.items():
        if key == "pid":
            yield key, dict(_state(value, replace))
        else:
            yield key, replaced(value, replace) if key in FORMULAS else value
