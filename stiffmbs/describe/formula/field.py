"""Formulas and tables as fields of elements: of time, of coordinates, of measures between markers, of a variable."""

from __future__ import annotations

import ast
from collections.abc import Collection, Container, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Real
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..files.quoted import quoted, written
from ..marker import GROUND, MarkerReference
from ..parts.names import Names, names_of
from ..table import Table
from ..units.quantity import as_float, is_unit, of_name
from ..units.units import ANY, CONSTANTS, UNITS, Quantity
from .check_dimensions import check_dimension
from .dimension import UNKNOWN, Known, measured_in
from .full_names import text_in_full, with_full_names
from .functions import IN_FORMULAS, check_functions
from .measured import dimension_within
from .names import COORDINATES, MEASURES, REACTIONS
from .state_names import with_states
from .text import UNIT, FormulaError, as_written, parse
from .variables import with_variables

TIME = "t"
TAKERS = (*MEASURES, *REACTIONS)
"""What is called with names: of markers, of joints."""


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
    dimension : Known
        Of its value.
    parameters : mapping of str to Quantity
        The scene's parameters among `values`, with their dimensions.
    expanded : str
        The text with the scene's variables in their places; empty where the scene has none.
    states : tuple of str
        The states of the model that it uses, by their full names.
    """

    text: str
    tree: ast.expr
    variables: tuple[str, ...]
    values: dict[str, float]
    velocities: bool = False
    tables: Mapping[str, Table] = field(default_factory=dict)
    dimension: Known = UNKNOWN
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    expanded: str = ""
    states: tuple[str, ...] = ()

    def coordinates(self) -> Iterator[tuple[str, str]]:
        """The (body, coordinate) pairs that it uses, in reading order."""
        yield from self._coordinates

    @cached_property
    def _coordinates(self) -> list[tuple[str, str]]:
        attributes = [node for node in reading_order(self.tree) if isinstance(node, ast.Attribute)]
        return [(x.value.id, x.attr) for x in attributes if isinstance(x.value, ast.Name) and x.value.id != UNIT]

    def measures(self) -> Iterator[tuple[str, tuple[MarkerReference, ...]]]:
        """The measures that it uses with their markers, in reading order."""
        yield from self._measures

    @cached_property
    def _measures(self) -> list[tuple[str, tuple[MarkerReference, ...]]]:
        calls = [node for node in reading_order(self.tree) if is_measure(node)]
        return [(node.func.id, measured_markers(node)) for node in calls]  # type: ignore[attr-defined]

    def reactions(self) -> Iterator[tuple[str, str]]:
        """The components of reactions that it uses, with their joints, in reading order."""
        yield from self._reactions

    @cached_property
    def _reactions(self) -> list[tuple[str, str]]:
        calls = [node for node in reading_order(self.tree) if is_reaction(node)]
        return [(node.func.id, joint_of(node)) for node in calls]  # type: ignore[attr-defined]

    @cached_property
    def kept(self) -> dict[Any, Any]:
        """What is worked out of it once, by what it is; nothing at first."""
        return {}

    def bodies(self) -> Iterator[str]:
        """The bodies that it names, some more than once."""
        for body, _ in self.coordinates():
            yield body
        for _, markers in self.measures():
            yield from (marker.body for marker in markers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Formula) and all(
            getattr(self, part) == getattr(other, part) for part in ("text", "values", "tables", "_told")
        )

    @property
    def _told(self) -> str:
        """What the tree says, with variables in their places."""
        return ast.unparse(self.tree)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Formula({self.text!r})"


def reading_order(tree: ast.expr) -> Iterator[ast.expr]:
    """All nodes, but neither the owner's name in ``cart.x``, nor a function's name, nor a measure's markers and a reaction's joint."""
    yield tree
    match tree:
        case ast.Attribute():
            return
        case ast.Call(_, arguments):
            children = [] if is_named(tree) else arguments
        case _:
            children = [child for child in ast.iter_child_nodes(tree) if isinstance(child, ast.expr)]
    for child in children:
        yield from reading_order(child)


def is_measure(node: ast.AST) -> bool:
    """Whether a node is a measure between markers such as ``dm(bar.end, ground)``."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in MEASURES


def is_reaction(node: ast.AST) -> bool:
    """Whether a node is a component of a joint's reaction such as ``fy(guide)``."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in REACTIONS


def is_named(node: ast.AST) -> bool:
    """Whether a node is a measure or a reaction, whose arguments are names."""
    return is_measure(node) or is_reaction(node)


def joint_of(node: ast.AST) -> str:
    """The joint of a reaction, by its full name."""
    assert isinstance(node, ast.Call)
    match node.args:
        case [ast.Name(joint)]:
            return joint
        case [ast.Attribute(ast.Name(owner), name)]:
            return f"{owner}.{name}"
    raise FormulaError(f"found '{ast.unparse(node)}', expected the name of one joint")


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


def formula_text(found: Any, expected: str = "a formula") -> str:
    """The text of a formula that is given as text, as a number, or as an expression of SymPy.

    Raises
    ------
    FormulaError
        For anything else.
    """
    if isinstance(found, Real) and not isinstance(found, bool):
        return repr(as_float(found))
    if hasattr(found, "free_symbols"):
        from sympy.printing.pycode import pycode

        return str(pycode(found, fully_qualified_modules=False))
    if not isinstance(found, str):
        raise FormulaError(f"found {written(found)}, expected {expected}")
    return found


def _without_meaning(text: str, own: Container[str]) -> Iterator[str]:
    """The names in a formula that are neither its own nor constants, units or time."""
    for node in reading_order(parse(text)):
        match node:
            case ast.Name(name) if name != TIME and not any(name in known for known in (own, UNITS, CONSTANTS)):
                yield name
            case ast.Attribute(ast.Name(owner), name) if owner != UNIT and name not in COORDINATES:
                yield f"{owner}.{name}"


@dataclass(frozen=True)
class FormulaOf:
    """Marks a field as a formula: ``Annotated[Formula, FormulaOf(("s",), ("length",), "force", time=False)]``.

    Parameters
    ----------
    variables : tuple of str
        Names with a meaning of the field's own.
    measured_in : tuple of str
        Their dimensions, of `stiffmbs.describe.units.units.DIMENSIONS`.
    dimension : str
        That of the value; `ANY` where every one will do.
    time, coordinates, velocities, table, states : bool
        Whether t, body coordinates and measures, and their rates may occur, a table may stand in its place, and states may
        occur where coordinates may not.
    """

    variables: tuple[str, ...] = ()
    measured_in: tuple[str, ...] = ()
    dimension: str = ANY
    time: bool = True
    coordinates: bool = False
    velocities: bool = False
    table: bool = False
    states: bool = False

    def read(self, found: Any, info: ValidationInfo) -> Formula | Table:
        """The checked formula or table of what stands in the scene."""
        if isinstance(found, Formula):
            self._check(found)
            return found
        if isinstance(found, Table | dict) and self.table:
            table = found if isinstance(found, Table) else Table.model_validate(found, context=info.context)
            self._check_table(table)
            return table
        context = info.context or {}
        parameters, tables, variables = (context.get(key) or {} for key in ("parameters", "tables", "variables"))
        names = names_of(info)
        if info.context is None and (
            self.coordinates or self.states
        ):  # built in Python, where the model that it will belong to is not known
            names = Names(states=dict.fromkeys(_without_meaning(formula_text(found), self.variables), UNKNOWN))
        formula = self._made(found, parameters, tables, variables, names)
        self._check(formula, names.inputs)
        return formula

    def _made(
        self,
        found: Any,
        parameters: Mapping[str, Quantity],
        tables: Mapping[str, Table],
        variables: Mapping[str, ast.expr],
        names: Names,
    ) -> Formula:
        found = formula_text(found, "a formula or a table" if self.table else "a formula")
        named = with_states(with_full_names(parse(found), names, TAKERS), names, self.variables, TAKERS)
        text = text_in_full(found, named, names)
        tree = with_variables(named, variables, self.variables)
        check_functions(tree, IN_FORMULAS, tables=tuple(tables), measures=TAKERS, listed=self._listed())
        used = dict(self.quantities(text, tree, parameters, names.states))
        if names.values:
            named, tree = (with_variables(each, names.values, self.variables) for each in (named, tree))
            text = text_in_full(found, named, names)
            used = dict(self.quantities(text, tree, parameters, names.states))
        expanded = as_written(tree) if variables else ""
        values = {name: quantity.value for name, quantity in used.items()}
        called = called_tables(tree, tables)
        dimension = self.dimension_of(tree, used, called, names.states)
        states = (node.id for node in reading_order(tree) if isinstance(node, ast.Name) and node.id in names.states)
        own = {name: quantity for name, quantity in used.items() if name in parameters}
        return Formula(
            text, tree, self.variables, values, self.velocities, called, dimension, own, expanded, tuple(dict.fromkeys(states))
        )  # fmt: skip

    def _listed(self) -> tuple[str, ...]:
        """Measures and reactions that may be called."""
        return (*MEASURES, *(REACTIONS if self.velocities else ())) if self.coordinates else ()

    def quantities(
        self, text: str, tree: ast.expr, known: Mapping[str, Quantity], states: Collection[str] = ()
    ) -> Iterator[tuple[str, Quantity]]:
        """The parameters, units and constants in a tree, in which other names may be states.

        Raises
        ------
        FormulaError
            For a name without a meaning, or with two.
        """
        for node in reading_order(tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if owner == UNIT:
                    if name not in UNITS:
                        raise FormulaError(f"found '{name}' after a number in '{quoted(text)}', expected a unit")
                    yield f"{UNIT}.{name}", UNITS[name]
                case ast.Name(name) if name != TIME and name not in self.variables and name not in states:
                    yield name, self._quantity(name, text, tree, known, states)

    def _quantity(
        self, name: str, text: str, tree: ast.expr, known: Mapping[str, Quantity], states: Collection[str]
    ) -> Quantity:
        stated = not self.variables or any(map(is_unit, ast.walk(tree)))
        units = UNITS if stated else {}  # a lone s in a law of v would be a second
        if name in known or name in units or name in CONSTANTS:
            return of_name(name, text, tree, known, units)
        meanings = [*self.variables, *(["t"] if self.time else [])]
        meanings += ["a body's coordinate such as cart.x"] if self.coordinates else []
        meanings += ["a parameter of the scene"]
        meanings += [f"a state or input ({', '.join(states)})"] if states and (self.coordinates or self.states) else []
        expected = ", ".join(meanings)
        raise FormulaError(f"found the unknown name '{name}' in '{quoted(text)}', expected {expected}")

    def dimension_of(
        self,
        tree: ast.expr,
        used: Mapping[str, Quantity],
        tables: Mapping[str, Table],
        terms: Mapping[str, Known] | None = None,
    ) -> Known:
        """The dimension of a formula's value, as `stiffmbs.describe.formula.measured.dimension_within`; `terms` are other
        names in the tree.
        """
        own = dict(zip(self.variables, map(measured_in, self.measured_in), strict=False))
        columns = {name: table.dimensions for name, table in tables.items()}
        return dimension_within(tree, used, own | dict(terms or {}), columns)

    def _check_table(self, table: Table) -> None:
        argument, value = table.dimensions
        check_dimension("the table's arguments", argument, *self.measured_in or ("time",))
        check_dimension("the table's values", value, self.dimension)

    def _check(self, formula: Formula, inputs: Container[str] = ()) -> None:
        if not self.time and any(isinstance(n, ast.Name) and n.id == TIME for n in reading_order(formula.tree)):
            raise FormulaError(f"found t in '{formula.text}', expected a formula without it")
        used = [f"{body}.{coordinate}" for body, coordinate in formula.coordinates()]
        used += [f"{name}(...)" for name, _ in formula.measures()]
        reactions = [f"{name}({joint})" for name, joint in formula.reactions()]
        if reactions and not self.velocities:
            raise FormulaError(
                f"found {reactions[0]} in '{formula.text}', expected a formula without reactions of joints"
            )
        used += [name for name in formula.states if name not in inputs and not self.states]
        if used and not self.coordinates:
            raise FormulaError(f"found {used[0]} in '{formula.text}', expected a formula without coordinates")
        check_dimension(f"'{quoted(formula.text)}', which is", formula.dimension, self.dimension)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        names = [*self.variables, *(["t"] if self.time else []), *(["coordinates"] if self.coordinates else [])]
        text = {"type": "string", "description": f"a formula of {', '.join(names) or 'numbers'}"}
        table = [handler(Table.__pydantic_core_schema__)] if self.table else []
        return {"anyOf": [text, {"type": "number"}, *table]}


OfTime = Annotated[Formula | Table, FormulaOf(table=True)]
"""A formula or a table of time."""
OfTimeAndStates = Annotated[Formula | Table, FormulaOf(table=True, states=True)]
"""The same with states in it."""
OfPosition = Annotated[Formula, FormulaOf(coordinates=True)]
"""A formula of coordinates and time."""
OfMotion = Annotated[Formula, FormulaOf(coordinates=True, velocities=True)]
"""A formula of coordinates, velocities and time."""
ForceOfMotion = Annotated[Formula, FormulaOf(dimension="force", coordinates=True, velocities=True)]
TorqueOfMotion = Annotated[Formula, FormulaOf(dimension="torque", coordinates=True, velocities=True)]
"""The same for a force, and for a torque."""
ForceOfDeflection = Annotated[Formula | Table, FormulaOf(("s",), ("length",), "force", time=False, table=True)]
TorqueOfDeflection = Annotated[Formula | Table, FormulaOf(("s",), ("angle",), "torque", time=False, table=True)]
"""A formula or a table of a deflection s."""
ForceOfRate = Annotated[Formula | Table, FormulaOf(("v",), ("velocity",), "force", time=False, table=True)]
TorqueOfRate = Annotated[Formula | Table, FormulaOf(("v",), ("angular velocity",), "torque", time=False, table=True)]
"""A formula or a table of a rate v."""
