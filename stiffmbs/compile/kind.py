"""Kinds: elements with the same equations, apart from their numbers, share one kind and so one kernel.

An element's fields are sorted into shapes (which equations) and data (bodies, numbers, tables, rows of joints that it
refers to), so that a change of a number never changes a kernel.
"""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..describe.element import Element, Joint, JointName
from ..describe.formula import UNIT
from ..describe.formula_field import TIME, Formula, is_measure, measured_markers
from ..describe.formula_value import formula_value
from ..describe.marker import Marker
from ..describe.model import ModelData
from ..describe.table import Table

Shape = tuple[Any, ...]


@dataclass(frozen=True)
class Kind:
    """What elements that share a kernel have in common.

    Attributes
    ----------
    element : type
        The class that holds the equations.
    n_bodies : int
        Bodies that one element acts on.
    n_joints : int
        Joints that it refers to.
    fields : tuple of (str, Shape)
        Its fields by name; a shape says of what form a field is, never its numbers.
    """

    element: type[Element]
    n_bodies: int
    n_joints: int
    fields: tuple[tuple[str, Shape], ...]


@dataclass
class ElementData:
    """What distinguishes an element from others of its kind.

    Attributes
    ----------
    bodies : list of str
        By slot; the first is the one on which the reaction is reported.
    numbers : list of float
        Kernel parameters, in the order in which the kind's equations meet them.
    tables : list of (int, ndarray)
        Which of the numbers stands for a table, by its offset in `flat`, and the table's spline data.
    joints : list of str
        Joints whose multipliers the equations use.
    """

    bodies: list[str] = field(default_factory=list)
    numbers: list[float] = field(default_factory=list)
    tables: list[tuple[int, np.ndarray]] = field(default_factory=list)
    joints: list[str] = field(default_factory=list)

    def slot(self, body: str) -> int:
        """The slot of a body, a new one where it is new."""
        if body not in self.bodies:
            self.bodies.append(body)
        return self.bodies.index(body)

    def flat(self) -> np.ndarray:
        """Numbers and tables in one row, each table's number being its offset from the start of the row."""
        numbers = np.array(self.numbers, dtype=float)
        end = len(numbers)
        parts = [numbers]
        for at, table in self.tables:
            numbers[at] = end
            parts.append(table)
            end += len(table)
        return np.concatenate(parts)


def sorted_out(element: Element, model: ModelData) -> tuple[Kind, ElementData]:
    """An element's kind, and what is its own."""
    data = ElementData()
    fields = _fields(element, model, data)
    return Kind(type(element), len(data.bodies), len(data.joints), fields), data


def _fields(element: Element, model: ModelData, data: ElementData) -> tuple[tuple[str, Shape], ...]:
    return tuple((name, _shape(getattr(element, name), model, data)) for name in type(element).model_fields)


def _shape(value: Any, model: ModelData, data: ElementData) -> Shape:
    """The shape of a field's value; its data are appended to `data`."""
    match value:
        case Marker():
            return _marker_shape(value, model, data)
        case JointName():
            joint: Joint = model.joints[value]
            fields = _fields(joint, model, data)
            data.joints.append(str(value))
            return ("joint", type(joint), fields, len(data.joints) - 1)
        case None | bool() | str():
            return ("choice", value)
        case int() | float():
            data.numbers.append(float(value))
            return ("number",)
        case Formula():
            return _FormulaShape(value, model, data).shape()
        case Table():
            data.tables.append((len(data.numbers), spline_data(value)))
            data.numbers.append(0.0)
            return ("table",)
        case tuple():
            return ("several", tuple(_shape(item, model, data) for item in value))
        case _:
            raise TypeError(f"a field of an element cannot hold {type(value).__name__}")


def _marker_shape(marker: Marker, model: ModelData, data: ElementData) -> Shape:
    placed = model.place(marker)
    slot = data.slot(marker.body)
    data.numbers += [*placed.point, placed.angle, math.cos(placed.angle), math.sin(placed.angle)]
    return ("marker", slot)


class _FormulaShape(ast.NodeTransformer):
    """Takes numbers, bodies and measures out of a formula.

    Bodies become ``b0.x``, variables ``v0``, measures ``measure0``, and every part that is constant one number
    ``p0``; whole exponents stay, as they decide about the derivatives.
    """

    def __init__(self, formula: Formula, model: ModelData, data: ElementData) -> None:
        self.formula, self.model, self.data = formula, model, data
        self.numbers: list[float] = []
        self.measures: list[tuple[str, tuple[Marker, ...]]] = []

    def shape(self) -> Shape:
        """The formula's shape; its numbers and markers are appended to the data."""
        tree = self.visit(ast.parse(ast.unparse(self.formula.tree), mode="eval").body)
        self.data.numbers += self.numbers
        measures = tuple(
            (name, tuple(_marker_shape(marker, self.model, self.data) for marker in markers))
            for name, markers in self.measures
        )
        return ("formula", ast.unparse(tree), len(self.formula.variables), len(self.numbers), measures)

    def visit(self, node: ast.AST) -> Any:
        constant = _constant_value(node, self.formula)
        if constant is not None:
            self.numbers.append(constant)
            return ast.Name(f"p{len(self.numbers) - 1}")
        return super().visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        match node:
            case ast.BinOp(
                base, ast.Pow(), ast.Constant(int()) | ast.UnaryOp(ast.USub(), ast.Constant(int())) as power
            ):
                return ast.BinOp(self.visit(base), ast.Pow(), power)
        return ast.BinOp(self.visit(node.left), node.op, self.visit(node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        return ast.UnaryOp(node.op, self.visit(node.operand))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        if is_measure(node):
            self.measures.append((node.func.id, measured_markers(node)))  # type: ignore[attr-defined]
            return ast.Name(f"measure{len(self.measures) - 1}")
        return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return node if node.id == TIME else ast.Name(f"v{self.formula.variables.index(node.id)}")

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        assert isinstance(node.value, ast.Name)
        return ast.Attribute(ast.Name(f"b{self.data.slot(node.value.id)}"), node.attr)


def _constant_value(node: ast.AST, formula: Formula) -> float | None:
    """The value of a part of a formula that holds neither time, coordinates, measures nor variables."""
    if not isinstance(node, ast.expr):
        return None
    for part in ast.walk(node):
        if is_measure(part) or (isinstance(part, ast.Name) and part.id in (TIME, *formula.variables)):
            return None
        if isinstance(part, ast.Attribute) and f"{UNIT}.{part.attr}" not in formula.values:
            return None
    return formula_value(formula, node)


NATURAL, PERIODIC = 0.0, 1.0


def spline_data(table: Table) -> np.ndarray:
    """What a kernel needs of a table: count, ends, knots, and the coefficients of each piece (highest first).

    Cubic spline interpolation by SciPy; straight lines are pieces without curvature.
    """
    x, y = np.array(table.table, dtype=float).T
    if table.lines:
        slope = np.diff(y) / np.diff(x)
        pieces = np.stack([np.zeros_like(slope), np.zeros_like(slope), slope, y[:-1]])
    else:
        from scipy.interpolate import CubicSpline

        if table.ends == "periodic":
            y = np.append(y[:-1], y[0])
        pieces = CubicSpline(x, y, bc_type=table.ends).c
    ends = PERIODIC if table.ends == "periodic" else NATURAL
    return np.concatenate([[len(x), ends], x, pieces.T.ravel()])
