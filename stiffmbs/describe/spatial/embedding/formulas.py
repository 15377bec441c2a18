"""Formulas of the plane in the names of space."""

from __future__ import annotations

import ast
import copy

from ...formula.field import Formula, is_measure, measured_markers
from ...formula.text import UNIT, as_written
from ...marker import GROUND, MarkerReference
from .angles import Angles


def formula(found: Formula, angles: Angles) -> str | float:
    """What a scene in space writes for a formula: its number, its text, or the text with other names."""
    try:
        return float(found.text)
    except ValueError:
        renamed = _Renamed(angles)
        tree = renamed.visit(copy.deepcopy(found.tree))
        return as_written(tree) if renamed.any else found.text


class _Renamed(ast.NodeTransformer):
    """Puts measures in the place of ``bar.angle``, ``bar.omega`` and ``az(a, b)``; all others have the same names."""

    def __init__(self, angles: Angles) -> None:
        self._angles = angles
        self.any = False

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        body = node.value.id  # type: ignore[attr-defined]
        match node.attr:
            case "angle" if body != UNIT:
                return self._angle(MarkerReference(body=body), MarkerReference(body=GROUND))
            case "omega" if body != UNIT:
                return self._read(f"wz({body})")
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        if not is_measure(node):
            return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])
        if node.func.id == "az":  # type: ignore[attr-defined]
            i, j, *_ = measured_markers(node)
            return self._angle(i, j)
        return node

    def _angle(self, i: MarkerReference, j: MarkerReference) -> ast.AST:
        return self._read(self._angles.measured(i, j))

    def _read(self, text: str) -> ast.AST:
        self.any = True
        return ast.parse(text, mode="eval").body
