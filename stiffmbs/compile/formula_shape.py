"""The shape of a formula: its text without numbers, bodies, measures and tables."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from ..describe.formula.formula import Formula
from ..describe.formula.nodes import TIME, is_measure, is_named, is_reaction, joint_of, measured_markers
from ..describe.formula.text import UNIT
from ..describe.formula.value import formula_value
from ..describe.joint_name import JointName
from ..describe.marker import MarkerReference
from ..describe.table import Table
from .table_values import spline_data

if TYPE_CHECKING:
    from .kind import Compilable, ElementData

Shape: TypeAlias = tuple[Any, ...]
"""Which equations a field makes, without its numbers."""

ShapeOf: TypeAlias = Callable[[Any, "Compilable", "ElementData"], Shape]
"""The shape of any value, whose data are appended."""
REACTION = "reaction"
"""Before the number of a joint's reaction in a formula's shape."""
STATE = "state"
"""Before the slot of a state in a formula's shape."""
TAKEN_OUT = "taken_out"
"""Under which a formula keeps what placeholders stand for in it."""
OWN = "own_"
"""Before the name of a coordinate that is seen in a body's own axes, which need not be its principal ones."""


@dataclass(frozen=True)
class Part:
    """A part of a formula.

    Attributes
    ----------
    number : int
        The same for parts that say the same word for word.
    constant : bool
        Whether it holds neither time, coordinates, measures, states nor the field's own variables.
    """

    number: int
    constant: bool


class FormulaParts:
    """What is known of the parts of a formula; each is looked at once.

    Parameters
    ----------
    formula : Formula
    """

    def __init__(self, formula: Formula) -> None:
        self._values = formula.values
        self._varying = {TIME, *formula.variables, *formula.tables, *formula.states}
        self._known: dict[int, Part] = {}
        self._numbers: dict[tuple[object, ...], int] = {}

    def of(self, node: ast.expr) -> Part:
        """A part by its node in the formula's tree."""
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
    """Takes numbers, bodies, measures and tables out of a formula.

    Bodies become ``b0.x``, states ``state0``, variables ``v0``, measures ``measure0``, tables ``table0(...)``, and every part that is
    constant one number ``p0``; whole exponents stay, as they decide about the derivatives.  What a formula repeats word
    for word is the same once more, numbers included: the road's phase in a sine and in a cosine is then computed once.
    """

    def __init__(self, formula: Formula, model: Compilable, data: ElementData, shape_of: ShapeOf) -> None:
        self.formula, self.model, self.data, self._shape_of = formula, model, data, shape_of
        self.numbers: list[float] = []
        self.constants: list[ast.expr] = []
        self.measures: list[tuple[str, tuple[Any, ...]]] = []
        self.tables: list[Table] = []
        self.reactions: list[tuple[str, str]] = []
        self._found: dict[int, ast.AST] = {}
        self._parts = FormulaParts(formula)

    def shape(self) -> Shape:
        """The formula's shape; its numbers and markers are appended to the data."""
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
        """What is left of the formula once numbers, markers and tables are taken out."""
        return ast.unparse(self.visit(self.formula.tree))

    def _read_once(self) -> str:
        """The same of a formula without states, kept with it: studies compile the same formulas again and again.

        The slots of bodies follow from those that an element has before.
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
        """A placeholder for a number, and the number noted."""
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
        match node:
            case ast.BinOp(
                base, ast.Pow(), ast.Constant(int()) | ast.UnaryOp(ast.USub(), ast.Constant(int())) as power
            ):
                return ast.BinOp(self.visit(base), ast.Pow(), power)
        return ast.BinOp(self.visit(node.left), node.op, self.visit(node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        return ast.UnaryOp(node.op, self.visit(node.operand))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """A placeholder for a measure, and the measure noted."""
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
        if node.id in self.formula.states:
            output = self.model.state_outputs().get(node.id)
            if output is not None:
                return self._inlined(output)
            return ast.Name(f"{STATE}{self.data.state_slot(node.id)}")
        return node if node.id == TIME else ast.Name(f"v{self.formula.variables.index(node.id)}")

    def _inlined(self, output: Formula) -> ast.AST:
        """The shape of another formula that stands in this one."""
        inner = FormulaShape(output, self.model, self.data, self._shape_of)
        inner.numbers, inner.measures, inner.tables, inner.reactions = (
            self.numbers,
            self.measures,
            self.tables,
            self.reactions,
        )
        tree: ast.AST = inner.visit(output.tree)
        return tree

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        assert isinstance(node.value, ast.Name)
        if self.model.dimensions == 3 and node.attr[0] in "qw":
            self.measures.append((OWN + node.attr, (MarkerReference(body=node.value.id),)))
            return ast.Name(f"measure{len(self.measures) - 1}")
        return ast.Attribute(ast.Name(f"b{self.data.slot(node.value.id)}"), node.attr)
