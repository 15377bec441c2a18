"""Kinds: elements with the same equations, apart from their numbers, share one kind and so one kernel.

Here an element's fields are sorted into structure (which equations) and numbers (kernel parameters), both ways
from one walk over the fields, so that a change of a number never changes a kernel.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..describe.element import Element
from ..describe.formula import UNIT, evaluate
from ..describe.formula_field import TIME, Formula
from ..describe.marker import Marker
from ..describe.model import ModelData

if TYPE_CHECKING:
    import sympy as sp

    from .frames import BodyFrame, SymbolicElement


@dataclass(frozen=True)
class Kind:
    """What elements that share a kernel have in common.

    Attributes
    ----------
    element : type
        The class that holds the equations.
    n_bodies : int
        Bodies that one element acts on.
    structure : tuple
        Its fields that decide about equations: names, lengths, and formulas with their numbers taken out.
    """

    element: type[Element]
    n_bodies: int
    structure: tuple[Any, ...]

    @property
    def label(self) -> str:
        return f"{self.element.__module__.rpartition('.')[2]}_{self.element.__name__}"

    @cached_property
    def symbolic(self) -> tuple[SymbolicElement, list[sp.Symbol]]:
        """The element for its equations, and the symbols of its numbers in the order of `numbers`."""
        import sympy as sp

        from .frames import MARKER_NUMBERS, BodyFrame, Frame, SymbolicElement

        frames = [BodyFrame(slot) for slot in range(self.n_bodies)]
        symbols: list[sp.Symbol] = []

        def fresh(name: str) -> sp.Symbol:
            symbols.append(sp.Symbol(name, real=True))
            return symbols[-1]

        fields: dict[str, object] = {}
        slot = 0
        for name, shape in self.structure:
            match shape:
                case "number":
                    fields[name] = fresh(name)
                case ("numbers", length):
                    fields[name] = tuple(fresh(f"{name}_{k}") for k in range(length))
                case "marker":
                    fields[name] = Frame(frames[slot], tuple(fresh(f"{name}_{part}") for part in MARKER_NUMBERS))
                    slot += 1
                case ("formulas", shapes):
                    fields[name] = [_formula(shape, frames, fresh, f"{name}_{k}") for k, shape in enumerate(shapes)]
        return SymbolicElement(frames, fields), symbols


def _formula(shape: tuple[str, int], frames: list[BodyFrame], fresh: Any, label: str) -> sp.Expr:
    """A formula's shape (see `_formula_shape`) as a SymPy expression with fresh symbols for its numbers."""
    import sympy as sp

    from .frames import SymbolicElement

    text, count = shape
    numbers = [fresh(f"{label}_p{k}") for k in range(count)]

    def names(name: str) -> sp.Expr:
        if name == TIME:
            return SymbolicElement.t
        owner, _, rest = name.partition(".")
        return frames[int(owner[1:])].coordinate(rest) if rest else numbers[int(owner[1:])]

    functions = {name: getattr(sp, name) for name in ("sin", "cos", "tan", "asin", "acos", "atan", "atan2")}
    functions |= {name: getattr(sp, name) for name in ("sinh", "cosh", "tanh", "exp", "log", "sqrt")}
    functions["abs"] = sp.Abs
    return sp.sympify(evaluate(ast.parse(text, mode="eval").body, names, functions, sp.sympify))


class _Shape(ast.NodeTransformer):
    """Takes the numbers out of a formula: bodies become b0, b1, ...; values and fractions p0, p1, ..."""

    def __init__(self, formula: Formula, bodies: tuple[str, ...]) -> None:
        self.values, self.bodies = formula.values, bodies
        self.numbers: list[float] = []

    def _number(self, value: float) -> ast.Name:
        self.numbers.append(value)
        return ast.Name(f"p{len(self.numbers) - 1}")

    def visit_Call(self, node: ast.Call) -> ast.AST:
        return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return node if node.id == TIME else self._number(self.values[node.id])

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        assert isinstance(node.value, ast.Name)
        if node.value.id == UNIT:
            return self._number(self.values[f"{UNIT}.{node.attr}"])
        return ast.Attribute(ast.Name(f"b{self.bodies.index(node.value.id)}"), node.attr)

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        return self._number(node.value) if isinstance(node.value, float) else node


def _formula_shape(formula: Formula, bodies: tuple[str, ...]) -> tuple[tuple[str, int], list[float]]:
    shape = _Shape(formula, bodies)
    tree = shape.visit(ast.parse(ast.unparse(formula.tree), mode="eval").body)
    return (ast.unparse(tree), len(shape.numbers)), shape.numbers


def _fields(element: Element, model: ModelData) -> Iterator[tuple[str, Any, list[float]]]:
    """Every field that equations may use: its name, its shape, and its numbers."""
    bodies = element.bodies()
    for name in type(element).model_fields:
        match getattr(element, name):
            case Marker() as marker:
                placed = model.place(marker)
                yield name, "marker", [*placed.point, placed.angle, math.cos(placed.angle), math.sin(placed.angle)]
            case bool() | str() | None:
                continue
            case int() | float() as value:
                yield name, "number", [float(value)]
            case Formula() as formula:
                shape, numbers = _formula_shape(formula, bodies)
                yield name, ("formulas", (shape,)), numbers
            case (Formula(), *_) as formulas:
                parts = [_formula_shape(formula, bodies) for formula in formulas]
                yield name, ("formulas", tuple(shape for shape, _ in parts)), [n for _, ns in parts for n in ns]
            case tuple() as values:
                yield name, ("numbers", len(values)), [float(value) for value in values]


def kind_of(element: Element, model: ModelData) -> Kind:
    """The kind that an element of the model belongs to."""
    structure = tuple((name, shape) for name, shape, _ in _fields(element, model))
    return Kind(type(element), len(element.bodies()), structure)


def numbers_of(element: Element, model: ModelData) -> list[float]:
    """The element's kernel parameters, in the order of `Kind.symbolic`."""
    return [number for _, _, numbers in _fields(element, model) for number in numbers]
