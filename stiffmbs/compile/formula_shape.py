"""Shape of a formula: its text without numbers, bodies, measures and tables."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from ..reading.formula.formula import Formula
from ..reading.formula.nodes import TIME, is_measure, is_named, is_reaction, joint_of, measured_markers
from ..reading.formula.text import UNIT
from ..reading.formula.value import formula_value
from ..reading.joint_name import JointName
from ..reading.marker import MarkerReference
from ..reading.table import Table
from .table_values import spline_data

if TYPE_CHECKING:
    from .kind import Compilable, ElementData

Shape: TypeAlias = tuple[Any, ...]
"""Structure of a field's equations without its numbers."""

ShapeOf: TypeAlias = Callable[[object, "Compilable", "ElementData"], Shape]
"""Function that returns the shape of a value and appends its data."""
REACTION = "reaction"
"""Prefix of the index of a joint's reaction or coordinate in a formula's shape."""
STATE = "state"
"""Prefix of the slot of a state in a formula's shape."""
TAKEN_OUT = "taken_out"
"""Cache key of a formula's extracted values."""
OWN = "own_"
"""Prefix of a coordinate in a body's own axes, which may differ from its principal axes."""


@dataclass(frozen=True)
class Part:
    """Part of a formula.

    `number`: equal for parts with the same text. `constant`: true without time, coordinates, measures, states and the
    field's variables.
    """

    number: int
    constant: bool


class FormulaParts:
    """Parts of a formula, each analysed once."""

    def __init__(self, formula: Formula) -> None:
        self._values = formula.values
        self._varying = {TIME, *formula.variables, *formula.tables, *formula.states}
        self._known: dict[int, Part] = {}
        self._numbers: dict[tuple[object, ...], int] = {}

    def of(self, node: ast.expr) -> Part:
        """Return the part of a node in the formula's tree."""
        if id(node) not in self._known:
            self._known[id(node)] = self._read(node)
        return self._known[id(node)]

    def _read(self, node: ast.expr) -> Part:
        match node:
            case ast.BinOp(left, operator, right):
                return self._of_parts((type(operator),), left, right)
            case ast.UnaryOp(operator, operand):
                return self._of_parts((type(operator),), operand)
            case ast.Call(ast.Name(name), arguments):
                return self._of_parts((ast.Call, name), *arguments, constant=not is_named(node) and name not in self._varying)  # fmt: skip
            case ast.Attribute(ast.Name(owner), name):
                return self._part((owner, name), f"{UNIT}.{name}" in self._values and owner not in self._varying)
            case ast.Name(name):
                return self._part((name,), name not in self._varying)
        return self._part((ast.dump(node),), isinstance(node, ast.Constant))

    def _of_parts(self, says: tuple[object, ...], *nodes: ast.expr, constant: bool = True) -> Part:
        parts = [self.of(node) for node in nodes]
        return self._part((*says, *(part.number for part in parts)), constant and all(part.constant for part in parts))

    def _part(self, says: tuple[object, ...], constant: bool) -> Part:
        return Part(self._numbers.setdefault(says, len(self._numbers)), constant)


class FormulaShape(ast.NodeVisitor):
    """Visitor that extracts numbers, bodies, measures and tables from a formula.

    Bodies become ``b0.x``, states ``state0``, variables ``v0``, measures ``measure0``, tables ``table0(...)``. Every
    constant part becomes a number ``p0``, except integer exponents, which determine the derivatives. Parts with the
    same text share one placeholder, so common subexpressions are computed once.
    """

    def __init__(self, formula: Formula, model: Compilable, data: ElementData, shape_of: ShapeOf) -> None:
        self.formula, self.model, self.data, self._shape_of = formula, model, data, shape_of
        self.numbers: list[float] = []
        self.constants: list[ast.expr] = []
        self.measures: list[tuple[str, Shape]] = []
        self.tables: list[Table] = []
        self.reactions: list[tuple[str, str]] = []
        self._found: dict[int, ast.AST] = {}
        self._parts = FormulaParts(formula)

    def shape(self) -> Shape:
        """Return the formula's shape; append its numbers and markers to the data."""
        text = self._read() if self.formula.states else self._read_once()
        self.data.numbers += self.numbers
        measures = tuple(
            (name, tuple(self.data.marker_shape(marker) for marker in markers)) for name, markers in self.measures
        )
        first = len(self.data.numbers)
        self.data.tables += [(first + k, spline_data(table)) for k, table in enumerate(self.tables)]
        self.data.numbers += [0.0] * len(self.tables)
        counts = len(self.formula.variables), len(self.numbers), len(self.tables)
        joints = {
            joint: self._shape_of(JointName(joint), self.model, self.data)
            for joint in dict.fromkeys(j for _, j in self.reactions)
        }
        reactions = tuple((name, joints[joint]) for name, joint in self.reactions)
        return ("formula", text, counts, measures, *([reactions] if reactions else []))

    def _read(self) -> str:
        """Return the formula with placeholders for numbers, markers and tables."""
        return ast.unparse(self.visit(self.formula.tree))

    def _read_once(self) -> str:
        """Return the same for a formula without states, cached in the formula for repeated compilation.

        The slots of bodies depend on those that the element already has.
        """
        kept, before = self.formula.kept, (TAKEN_OUT, tuple(self.data.bodies))
        if before not in kept:
            text = self._read()
            kept[before] = text, list(self.data.bodies), self.constants, self.measures, self.tables, self.reactions
        text, bodies, constants, measures, tables, reactions = kept[before]
        self.data.bodies, self.measures, self.tables, self.reactions = map(
            copy.copy, (bodies, measures, tables, reactions)
        )
        self.numbers = [formula_value(self.formula, node) for node in constants]
        return str(text)

    def visit(self, node: ast.AST) -> Any:
        """Replace a constant part by a placeholder, and record its value."""
        assert isinstance(node, ast.expr)
        part = self._parts.of(node)
        if part.constant:
            self.constants.append(node)
            self.numbers.append(formula_value(self.formula, node))
            return ast.Name(f"p{len(self.numbers) - 1}")
        if part.number not in self._found:
            self._found[part.number] = super().visit(node)
        return self._found[part.number]

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """Replace the operands; an integer exponent stays a literal."""
        match node:
            case ast.BinOp(
                base, ast.Pow(), ast.Constant(int()) | ast.UnaryOp(ast.USub(), ast.Constant(int())) as power
            ):
                return ast.BinOp(self.visit(base), ast.Pow(), power)
        return ast.BinOp(self.visit(node.left), node.op, self.visit(node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        """Replace the operand."""
        return ast.UnaryOp(node.op, self.visit(node.operand))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Replace a measure, reaction or table call by a placeholder, and record it."""
        if is_measure(node):
            self.measures.append((node.func.id, measured_markers(node)))  # type: ignore[attr-defined]
            return ast.Name(f"measure{len(self.measures) - 1}")
        if is_reaction(node):
            self.reactions.append((node.func.id, joint_of(node)))  # type: ignore[attr-defined]
            return ast.Name(f"{REACTION}{len(self.reactions) - 1}")
        arguments = [self.visit(argument) for argument in node.args]
        table = self.formula.tables.get(node.func.id)  # type: ignore[attr-defined]
        if table is None:
            return ast.Call(node.func, arguments, [])
        self.tables.append(table)
        return ast.Call(ast.Name(f"table{len(self.tables) - 1}"), arguments, [])

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Replace a state by its place or the formula of its output, and a variable by its number."""
        if node.id in self.formula.states:
            output = self.model.state_outputs().get(node.id)
            if output is not None:
                return self._inlined(output)
            return ast.Name(f"{STATE}{self.data.state_slot(node.id)}")
        return node if node.id == TIME else ast.Name(f"v{self.formula.variables.index(node.id)}")

    def _inlined(self, output: Formula) -> ast.AST:
        inner = FormulaShape(output, self.model, self.data, self._shape_of)
        for shared in ("numbers", "measures", "tables", "reactions"):
            setattr(inner, shared, getattr(self, shared))
        tree: ast.AST = inner.visit(output.tree)
        return tree

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Replace a reaction or measured coordinate by a placeholder, and a body by its number."""
        assert isinstance(node.value, ast.Name)
        if node.value.id in self.model.joints:
            self.reactions.append((node.attr, node.value.id))
            return ast.Name(f"{REACTION}{len(self.reactions) - 1}")
        if self.model.dimensions == 3 and node.attr[0] in "qw":
            self.measures.append((OWN + node.attr, (MarkerReference.model_construct(body=node.value.id),)))
            return ast.Name(f"measure{len(self.measures) - 1}")
        return ast.Attribute(ast.Name(f"b{self.data.slot(node.value.id)}"), node.attr)
