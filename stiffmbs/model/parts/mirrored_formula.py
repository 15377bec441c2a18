"""Formulas and tables of mirrored parts."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...reading.formula.formula import Formula
from ...reading.formula.nodes import is_measure, measured_markers
from ...reading.formula.text import UNIT, FormulaError, as_written
from ...reading.marker import GROUND, MarkerReference
from ...reading.table import Table

if TYPE_CHECKING:
    from .planar_frame import PlanarFrame
    from .spatial_frame import SpatialFrame

SCALARS = ("dm", "vm", "vr", "wm")
ANGLES = ("ax", "ay", "az")
Signs = tuple[float, ...]


@dataclass
class MirroredNames(ast.NodeTransformer):
    """Replace each coordinate and measure by its mirror image: the same, or its negative."""

    frame: PlanarFrame | SpatialFrame  # of the part in ground axes
    inside: Callable[[MarkerReference], bool]  # returns True if a marker belongs to the part or its mounts
    # returns the sign of a joint's coordinate, given the names of both; None if the part has no such joint
    along_joint: Callable[[str, str], float | None]

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Return a coordinate or velocity with its sign in the mirrored part."""
        body = node.value.id  # type: ignore[attr-defined]
        if body == UNIT:
            return node
        if (sign := self.along_joint(body, node.attr)) is not None:
            return _signed(node, sign)
        if not self.inside(MarkerReference(body=body)):
            raise FormulaError(f"found '{body}', which is outside of a mirrored part, expected what is in it")
        match node.attr:
            case "x" | "y" | "z" if self._of_ground(node)["xyz".index(node.attr)] > 0:  # parallel to the mirror
                return node
            case "vx" | "vy" | "vz":
                return _signed(node, self._of_ground(node)["xyz".index(node.attr[1])])
            case "wx" | "wy" | "wz":  # along the body's axes
                return _signed(node, self.frame.rotation_signs["xyz".index(node.attr[1])])
            case "omega":
                return _signed(node, self.frame.handedness)
        raise FormulaError(
            f"found '{ast.unparse(node)}' in a mirrored part, expected positions against it, such as dx({body}, mount)"
        )

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Return a measure with its sign in the mirrored part."""
        if not is_measure(node):
            return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])
        name: str = node.func.id  # type: ignore[attr-defined]
        i, j, *axes = measured_markers(node)
        for marker in (i, j, *axes):
            against_ground = marker is j and j.body == GROUND and (name[0] in "vw" or self._kept(node, name, axes))
            if not (against_ground or self.inside(marker)):
                raise FormulaError(
                    f"found '{marker.label}' in '{ast.unparse(node)}', which is outside of a mirrored part, expected what is "
                    "in it, or mount"
                )
        if name in SCALARS:
            return node
        turning = name in ANGLES or name[0] == "w"
        own = axes or name in ANGLES
        signs = self.frame.signs if own else self._of_ground(node)
        if turning:
            return _signed(
                node, self.frame.handedness * ([*signs, 1.0, 1.0]["xyz".index(name[1])] if len(signs) == 3 else 1.0)
            )
        return _signed(node, signs["xyz".index(name[1])])

    def _kept(self, node: ast.AST, name: str, axes: list[MarkerReference]) -> bool:
        """Return True if mirroring does not change a position relative to ground."""
        return name in ("dx", "dy", "dz") and not axes and self._of_ground(node)["xyz".index(name[1])] > 0

    def _of_ground(self, node: ast.AST) -> Signs:
        signs: Signs | None = self.frame.ground_signs()
        if signs is None:
            raise FormulaError(
                f"found '{ast.unparse(node)}' along the ground's axes, to which the mirror is oblique, expected a third "
                "marker, of the part, whose axes it is along"
            )
        return signs


def _signed(node: ast.expr, sign: float) -> ast.expr:
    return node if sign > 0 else ast.UnaryOp(ast.USub(), node)


def mirrored_law(found: Formula | Table, names: MirroredNames, value: float, argument: float) -> Formula | Table:
    """Return value * f(argument * x) for a formula or table f, with mirrored coordinates; states keep their values.

    `value`, `argument`: 1 or -1; `argument` applies to the variables that the field defines.
    """
    if isinstance(found, Table):
        points = tuple((argument * x, value * y) for x, y in found.table)
        return found.model_copy(update={"table": points if argument > 0 else points[::-1]})
    for name, joint in found.reactions():
        raise FormulaError(
            f"found '{name}({joint})' in a mirrored part, expected a formula without reactions of joints"
        )
    tree = names.visit(copy.deepcopy(found.tree))
    if argument < 0:
        tree = _Negated(found.variables).visit(tree)
    tree = _signed(tree, value)
    text = as_written(tree)
    return replace(found, tree=tree, text=text)


@dataclass
class _Negated(ast.NodeTransformer):
    variables: tuple[str, ...]

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        return node if is_measure(node) else ast.Call(node.func, [self.visit(a) for a in node.args], [])

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return ast.UnaryOp(ast.USub(), node) if node.id in self.variables else node
