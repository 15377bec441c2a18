"""Formulas and tables as fields of elements: of time, of coordinates, of measures between markers, of a variable."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from .formula import UNIT, FormulaError, parse
from .marker import Marker
from .quantity import CONSTANTS, UNITS, Quantity
from .table import Table

TIME = "t"
POSITIONS = ("x", "y", "angle")
VELOCITIES = ("vx", "vy", "omega")
POSITION_MEASURES = ("dx", "dy", "dm", "az")
VELOCITY_MEASURES = ("vx", "vy", "vm", "vr", "wz")
FUNCTIONS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    "abs", "sign", "min", "max", "step", "step5",
)  # fmt: skip
"""What formulas may call.  ``step(x, x0, h0, x1, h1)`` goes from h0 to h1 by a cubic, ``step5`` by a quintic."""


@dataclass(frozen=True, eq=False)
class Formula:
    """A checked formula.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its syntax tree (`stiffmbs.describe.formula.parse`).
    variables : tuple of str
        Names that the field gives a meaning to (``s`` and ``v`` of a spring's law).
    values : dict of str to float
        The scene's parameters, units and constants that it uses, in SI units.
    """

    text: str
    tree: ast.expr
    variables: tuple[str, ...]
    values: dict[str, float]

    def coordinates(self) -> Iterator[tuple[str, str]]:
        """The (body, coordinate) pairs that it uses, in reading order."""
        for node in reading_order(self.tree):
            match node:
                case ast.Attribute(ast.Name(body), coordinate) if body != UNIT:
                    yield body, coordinate

    def measures(self) -> Iterator[tuple[str, tuple[Marker, ...]]]:
        """The measures that it uses with their markers, in reading order."""
        for node in reading_order(self.tree):
            if is_measure(node):
                yield node.func.id, measured_markers(node)  # type: ignore[attr-defined]

    def bodies(self) -> Iterator[str]:
        """The bodies that it names, some more than once."""
        for body, _ in self.coordinates():
            yield body
        for _, markers in self.measures():
            yield from (marker.body for marker in markers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Formula) and (self.text, self.values) == (other.text, other.values)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Formula({self.text!r})"


def reading_order(tree: ast.expr) -> Iterator[ast.expr]:
    """All nodes, but neither the owner's name in ``cart.x``, nor a function's name, nor a measure's markers."""
    yield tree
    match tree:
        case ast.Attribute():
            return
        case ast.Call(_, arguments):
            children = [] if is_measure(tree) else arguments
        case _:
            children = [child for child in ast.iter_child_nodes(tree) if isinstance(child, ast.expr)]
    for child in children:
        yield from reading_order(child)


def is_measure(node: ast.AST) -> bool:
    """Whether a node is a measure between markers such as ``dm(bar.end, ground)``."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in MEASURES


MEASURES = tuple(dict.fromkeys((*POSITION_MEASURES, *VELOCITY_MEASURES)))


def measured_markers(node: ast.AST) -> tuple[Marker, ...]:
    """The markers of a measure: one or two references to bodies or their markers; ground where one is left out."""
    assert isinstance(node, ast.Call)
    markers = []
    for argument in node.args:
        match argument:
            case ast.Name(body):
                markers.append(Marker(body=body))
            case ast.Attribute(ast.Name(body), marker):
                markers.append(Marker(body=body, marker=marker))
            case _:
                raise FormulaError(f"found '{ast.unparse(argument)}' in a measure, expected a body or body.marker")
    if len(markers) not in (1, 2):
        raise FormulaError(f"found {len(markers)} markers in '{ast.unparse(node)}', expected one or two")
    return tuple(markers) if len(markers) == 2 else (markers[0], Marker(body="ground"))


@dataclass(frozen=True)
class FormulaOf:
    """Marks a field as a formula: ``Annotated[Formula, FormulaOf(("s",), time=False)]``.

    Parameters
    ----------
    variables : tuple of str
        Names with a meaning of the field's own.
    time, coordinates, velocities, table : bool
        Whether t, body coordinates and measures, and their rates may occur, and a table may stand in its place.
    """

    variables: tuple[str, ...] = ()
    time: bool = True
    coordinates: bool = False
    velocities: bool = False
    table: bool = False

    def read(self, found: Any, info: ValidationInfo) -> Formula | Table:
        """The checked formula or table of what stands in the scene."""
        parameters: dict[str, Quantity] = (info.context or {}).get("parameters") or {}
        if isinstance(found, Formula):
            self._check(found)
            return found
        if isinstance(found, Table | dict) and self.table:
            return found if isinstance(found, Table) else Table.model_validate(found, context=info.context)
        formula = self._made(found, {name: value.value for name, value in parameters.items()})
        self._check(formula)
        return formula

    def _made(self, found: Any, known: dict[str, float]) -> Formula:
        if isinstance(found, int | float) and not isinstance(found, bool):
            found = repr(float(found))
        elif hasattr(found, "free_symbols"):
            from sympy.printing.pycode import pycode

            found = pycode(found, fully_qualified_modules=False)
        if not isinstance(found, str):
            allowed = "a formula or a table" if self.table else "a formula"
            raise FormulaError(f"found {found!r}, expected {allowed}")
        tree = parse(found)
        return Formula(found, tree, self.variables, dict(self._values(found, tree, known)))

    def _values(self, text: str, tree: ast.expr, known: dict[str, float]) -> Iterator[tuple[str, float]]:
        for node in reading_order(tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if owner == UNIT:
                    if name not in UNITS:
                        raise FormulaError(f"found '{name}' after a number in '{text}', expected a unit")
                    yield f"{UNIT}.{name}", UNITS[name].value
                case ast.Call(ast.Name(name)) if name not in (*FUNCTIONS, *MEASURES):
                    listed = ", ".join((*FUNCTIONS, *MEASURES) if self.coordinates else FUNCTIONS)
                    raise FormulaError(f"found the unknown function '{name}', expected one of {listed}")
                case ast.Name(name) if name != TIME and name not in self.variables:
                    yield name, self._value(text, name, known)

    def _value(self, text: str, name: str, known: dict[str, float]) -> float:
        if name in known:
            return known[name]
        units = {} if self.variables else UNITS  # a lone s in a law of v would be a second
        for table in (units, CONSTANTS):
            if name in table:
                return table[name].value
        meanings = [*self.variables, *(["t"] if self.time else [])]
        meanings += ["a body's coordinate such as cart.x"] if self.coordinates else []
        expected = ", ".join([*meanings, "a parameter of the scene"])
        raise FormulaError(f"found the unknown name '{name}' in '{text}', expected {expected}")

    def _check(self, formula: Formula) -> None:
        if not self.time and any(isinstance(n, ast.Name) and n.id == TIME for n in reading_order(formula.tree)):
            raise FormulaError(f"found t in '{formula.text}', expected a formula without it")
        used = [f"{body}.{coordinate}" for body, coordinate in formula.coordinates()]
        used += [f"{name}(...)" for name, _ in formula.measures()]
        if used and not self.coordinates:
            raise FormulaError(f"found {used[0]} in '{formula.text}', expected a formula without coordinates")
        allowed = (*POSITIONS, *(VELOCITIES if self.velocities else ()))
        for body, coordinate in formula.coordinates():
            if coordinate not in allowed:
                raise FormulaError(f"found '{body}.{coordinate}', expected one of {body}.{f', {body}.'.join(allowed)}")
        for name, _ in formula.measures():
            if name in VELOCITY_MEASURES and not self.velocities:
                raise FormulaError(f"found the velocity {name} in '{formula.text}', expected positions only")

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        names = [*self.variables, *(["t"] if self.time else []), *(["coordinates"] if self.coordinates else [])]
        text = {"type": "string", "description": f"a formula of {', '.join(names) or 'numbers'}"}
        table = [handler(Table.__pydantic_core_schema__)] if self.table else []
        return {"anyOf": [text, {"type": "number"}, *table]}


OfTime = Annotated[Formula | Table, FormulaOf(table=True)]
"""A formula or a table of time."""
OfPosition = Annotated[Formula, FormulaOf(coordinates=True)]
"""A formula of coordinates and time."""
OfMotion = Annotated[Formula, FormulaOf(coordinates=True, velocities=True)]
"""A formula of coordinates, velocities and time."""
OfDeflection = Annotated[Formula | Table, FormulaOf(("s",), time=False, table=True)]
"""A formula or a table of a deflection s."""
OfRate = Annotated[Formula | Table, FormulaOf(("v",), time=False, table=True)]
"""A formula or a table of a rate v."""
