"""Formulas and tables as fields of elements: of time, of coordinates, of measures between markers, of a variable."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..files.quoted import quoted, written
from ..marker import GROUND, MarkerReference
from ..names import Names, names_of
from ..table import Table
from ..units.quantity import as_float
from ..units.units import CONSTANTS, UNITS, Quantity
from .full_names import text_in_full, with_full_names
from .functions import FUNCTIONS, OF_TABLE, check_functions
from .names import MEASURES
from .text import UNIT, FormulaError, parse

TIME = "t"


@dataclass(frozen=True, eq=False)
class Formula:
    """A checked formula.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its syntax tree (`stiffmbs.describe.formula.text.parse`).
    variables : tuple of str
        Names that the field gives a meaning to (``s`` and ``v`` of a spring's law).
    values : dict of str to float
        The scene's parameters, units and constants that it uses, in SI units.
    velocities : bool
        Whether it may hold velocities.
    tables : mapping of str to Table
        The scene's tables that it calls as functions.
    """

    text: str
    tree: ast.expr
    variables: tuple[str, ...]
    values: dict[str, float]
    velocities: bool = False
    tables: Mapping[str, Table] = field(default_factory=dict)

    def coordinates(self) -> Iterator[tuple[str, str]]:
        """The (body, coordinate) pairs that it uses, in reading order."""
        for node in reading_order(self.tree):
            match node:
                case ast.Attribute(ast.Name(body), coordinate) if body != UNIT:
                    yield body, coordinate

    def measures(self) -> Iterator[tuple[str, tuple[MarkerReference, ...]]]:
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
        return isinstance(other, Formula) and all(
            getattr(self, part) == getattr(other, part) for part in ("text", "values", "tables")
        )

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


def measured_markers(node: ast.AST) -> tuple[MarkerReference, ...]:
    """The markers of a measure: two references to bodies or their markers, ground where one is left out, and perhaps a
    third one, whose axes the measure is taken along.
    """
    assert isinstance(node, ast.Call)
    markers = []
    for argument in node.args:
        match argument:
            case ast.Name(body):
                markers.append(MarkerReference(body=body))
            case ast.Attribute(ast.Name(body), marker):
                markers.append(MarkerReference(body=body, marker=marker))
            case _:
                raise FormulaError(f"found '{ast.unparse(argument)}' in a measure, expected a body or body.marker")
    if len(markers) not in (1, 2, 3):
        raise FormulaError(f"found {len(markers)} markers in '{ast.unparse(node)}', expected one to three")
    return tuple(markers) if len(markers) > 1 else (markers[0], MarkerReference(body=GROUND))


def called_tables(tree: ast.expr, tables: Mapping[str, Table]) -> dict[str, Table]:
    """The tables that a formula calls, by name."""
    called = (node.func.id for node in reading_order(tree) if isinstance(node, ast.Call))  # type: ignore[attr-defined]
    return {name: tables[name] for name in called if name in tables}


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
        known = {name: value.value for name, value in parameters.items()}
        formula = self._made(found, known, (info.context or {}).get("tables") or {}, names_of(info))
        self._check(formula)
        return formula

    def _made(self, found: Any, parameters: dict[str, float], tables: Mapping[str, Table], names: Names) -> Formula:
        if isinstance(found, Real) and not isinstance(found, bool):
            found = repr(as_float(found))
        elif hasattr(found, "free_symbols"):
            from sympy.printing.pycode import pycode

            found = pycode(found, fully_qualified_modules=False)
        if not isinstance(found, str):
            allowed = "a formula or a table" if self.table else "a formula"
            raise FormulaError(f"found {written(found)}, expected {allowed}")
        tree = with_full_names(parse(found), names, MEASURES)
        found = text_in_full(found, tree, names)
        known = FUNCTIONS | dict.fromkeys(tables, OF_TABLE)
        check_functions(tree, known, MEASURES, (*known, *MEASURES) if self.coordinates else tuple(known))
        values = dict(self.values(found, tree, parameters))
        return Formula(found, tree, self.variables, values, self.velocities, called_tables(tree, tables))

    def values(self, text: str, tree: ast.expr, known: Mapping[str, float]) -> Iterator[tuple[str, float]]:
        """The parameters, units and constants in a tree with their values in SI units.

        Raises
        ------
        FormulaError
            For a name without a meaning.
        """
        for node in reading_order(tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if owner == UNIT:
                    if name not in UNITS:
                        raise FormulaError(f"found '{name}' after a number in '{quoted(text)}', expected a unit")
                    yield f"{UNIT}.{name}", UNITS[name].value
                case ast.Name(name) if name != TIME and name not in self.variables:
                    yield name, self._value(text, name, known)

    def _value(self, text: str, name: str, known: Mapping[str, float]) -> float:
        if name in known:
            return known[name]
        units = {} if self.variables else UNITS  # a lone s in a law of v would be a second
        for table in (units, CONSTANTS):
            if name in table:
                return table[name].value
        meanings = [*self.variables, *(["t"] if self.time else [])]
        meanings += ["a body's coordinate such as cart.x"] if self.coordinates else []
        expected = ", ".join([*meanings, "a parameter of the scene"])
        raise FormulaError(f"found the unknown name '{name}' in '{quoted(text)}', expected {expected}")

    def _check(self, formula: Formula) -> None:
        if not self.time and any(isinstance(n, ast.Name) and n.id == TIME for n in reading_order(formula.tree)):
            raise FormulaError(f"found t in '{formula.text}', expected a formula without it")
        used = [f"{body}.{coordinate}" for body, coordinate in formula.coordinates()]
        used += [f"{name}(...)" for name, _ in formula.measures()]
        if used and not self.coordinates:
            raise FormulaError(f"found {used[0]} in '{formula.text}', expected a formula without coordinates")

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
