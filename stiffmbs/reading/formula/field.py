"""Formulas and tables as fields of elements."""

from __future__ import annotations

import ast
from collections.abc import Collection, Container, Iterator, Mapping
from dataclasses import dataclass, replace
from numbers import Real
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from ..did_you_mean import did_you_mean
from ..files.quoted import quoted, written
from ..joint_name import JOINT_CHANNELS
from ..names import Names, names_of
from ..table import Table
from ..units.quantity import as_float, is_unit, of_name
from ..units.units import ANY, CONSTANTS, UNITS, Quantity
from .dimension import UNKNOWN, Known, measured_in
from .formula import Formula, called_tables
from .full_names import text_in_full, with_full_names
from .functions import IN_FORMULAS, check_functions
from .measured import check_dimension, dimension_within
from .names import COORDINATES, MEASURES, REACTIONS
from .nodes import TAKERS, TIME, reading_order
from .text import UNIT, FormulaError, parse
from .variables import with_variables

READ_BEFORE = "formulas"
"""Key in the validation context: formulas read before with the same names, by text, variables and use of velocities."""


def formula_text(found: object, expected: str = "a formula") -> str:
    """Return the text of a formula given as text, number or SymPy expression; raise a FormulaError for any other value."""
    if isinstance(found, Real) and not isinstance(found, bool):
        return repr(as_float(found))
    if hasattr(found, "free_symbols"):
        from sympy.printing.pycode import pycode

        return str(pycode(found, fully_qualified_modules=False))
    if not isinstance(found, str):
        raise FormulaError(f"found {written(found)}, expected {expected}")
    return found


def _without_meaning(text: str, own: Container[str]) -> Iterator[str]:
    """Yield the names in a formula that are neither its own nor constants, units or time."""
    for node in reading_order(parse(text)):
        match node:
            case ast.Name(name) if name != TIME and not any(name in known for known in (own, UNITS, CONSTANTS)):
                yield name
            case ast.Attribute(ast.Name(owner), name) if not (
                owner == UNIT or name in COORDINATES or name in JOINT_CHANNELS
            ):
                yield f"{owner}.{name}"


@dataclass(frozen=True)
class FormulaOf:
    """Marker of a formula field: ``Annotated[Formula, FormulaOf(("s",), ("length",), "force", time=False)]``."""

    variables: tuple[str, ...] = ()  # names defined by the field
    measured_in: tuple[str, ...] = ()  # their dimensions, of `stiffmbs.reading.units.units.DIMENSIONS`
    dimension: str = ANY  # of the value; `ANY` if unrestricted
    # permission of t, of body coordinates and measures, of their rates, of a table in place of the formula, and of
    # states without coordinates
    time: bool = True
    coordinates: bool = False
    velocities: bool = False
    table: bool = False
    states: bool = False

    def read(self, found: object, info: ValidationInfo) -> Formula | Table:
        """Return the checked formula or table of an entry of a scene."""
        if isinstance(found, Formula):
            self._check(found)
            return found
        if isinstance(found, Table | dict) and self.table:
            table = found if isinstance(found, Table) else Table.model_validate(found, context=info.context)
            self._check_table(table)
            return table
        context = info.context or {}
        names = names_of(info)
        if info.context is None and (self.coordinates or self.states):  # built in Python, before it belongs to a model
            names = Names(states=dict.fromkeys(_without_meaning(formula_text(found), self.variables), UNKNOWN))
        known = context.get(READ_BEFORE)
        before = known.get((found, self.variables, self.velocities)) if known and isinstance(found, str) else None
        if before is None:
            formula = self._made(found, context, names)
        else:
            formula = self._with_parameters(before, context.get("parameters") or {}, names)
        self._check(formula, names.inputs)
        return formula

    def _with_parameters(self, before: Formula, parameters: Mapping[str, Quantity], names: Names) -> Formula:
        """Return the formula of the same text with other parameters."""
        used = dict(self.quantities(before.text, before.tree, parameters, before.states))
        return replace(
            before,
            values={name: quantity.value for name, quantity in used.items()},
            dimension=self.dimension_of(before.tree, used, before.tables, names.states),
            parameters={name: quantity for name, quantity in used.items() if name in parameters},
        )

    def _made(self, found: object, context: Mapping[str, Any], names: Names) -> Formula:
        parameters, tables, variables = (context.get(key) or {} for key in ("parameters", "tables", "variables"))
        found = formula_text(found, "a formula or a table" if self.table else "a formula")
        named = with_full_names(parse(found), names, TAKERS, self.variables)
        text = text_in_full(found, named, names)
        tree = with_variables(named, variables, self.variables)
        check_functions(tree, IN_FORMULAS, tables=tuple(tables), measures=TAKERS, listed=self._listed())
        used = dict(self.quantities(text, tree, parameters, names.states))
        if names.values:
            named, tree = (with_variables(each, names.values, self.variables) for each in (named, tree))
            text = text_in_full(found, named, names)
            used = dict(self.quantities(text, tree, parameters, names.states))
        values = {name: quantity.value for name, quantity in used.items()}
        called = called_tables(tree, tables)
        dimension = self.dimension_of(tree, used, called, names.states)
        states = (node.id for node in reading_order(tree) if isinstance(node, ast.Name) and node.id in names.states)
        own = {name: quantity for name, quantity in used.items() if name in parameters}
        return Formula(
            text, tree, self.variables, values, self.velocities, called, dimension, own, bool(variables), tuple(dict.fromkeys(states))
        )  # fmt: skip

    def _listed(self) -> tuple[str, ...]:
        return (*MEASURES, *(REACTIONS if self.velocities else ())) if self.coordinates else ()

    def quantities(
        self, text: str, tree: ast.expr, known: Mapping[str, Quantity], states: Collection[str] = ()
    ) -> Iterator[tuple[str, Quantity]]:
        """Yield the parameters, units and constants in a tree; `states` are other valid names.

        Raise a FormulaError for an unknown or ambiguous name.
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
        units = UNITS if stated else {}  # otherwise s in a law of v would mean seconds
        if name in known or name in units or name in CONSTANTS:
            return of_name(name, text, tree, known, units)
        meanings = [*self.variables, *(["t"] if self.time else [])]
        meanings += ["a body's coordinate such as cart.x"] if self.coordinates else []
        meanings += ["a parameter of the scene"]
        meanings += [f"a state or input ({', '.join(states)})"] if states and (self.coordinates or self.states) else []
        expected, near = ", ".join(meanings), did_you_mean(name, (*self.variables, *known, *states))
        raise FormulaError(f"found the unknown name '{name}'{near} in '{quoted(text)}', expected {expected}")

    def dimension_of(
        self, tree: ast.expr, used: Mapping[str, Quantity], tables: Mapping[str, Table], terms: Mapping[str, Known]
    ) -> Known:
        """Return the dimension of a formula's value, as `stiffmbs.reading.formula.measured.dimension_within`.

        `terms` are other names in the tree.
        """
        own = dict(zip(self.variables, map(measured_in, self.measured_in), strict=False))
        columns = {name: table.dimensions for name, table in tables.items()}
        return dimension_within(tree, used, {**own, **terms}, columns)

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

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: object, handler: GetJsonSchemaHandler) -> dict[str, object]:
        names = [*self.variables, *(["t"] if self.time else []), *(["coordinates"] if self.coordinates else [])]
        text = {"type": "string", "description": f"a formula of {', '.join(names) or 'numbers'}"}
        table = [handler(Table.__pydantic_core_schema__)] if self.table else []
        return {"anyOf": [text, {"type": "number"}, *table]}


OfTime = Annotated[Formula | Table, FormulaOf(table=True)]
"""Formula or table of time."""
OfTimeAndStates = Annotated[Formula | Table, FormulaOf(table=True, states=True)]
"""Formula or table of time and of states."""
OfPosition = Annotated[Formula, FormulaOf(coordinates=True)]
"""Formula of coordinates and time."""
OfMotion = Annotated[Formula, FormulaOf(coordinates=True, velocities=True)]
"""Formula of coordinates, velocities and time."""
ForceOfMotion = Annotated[Formula, FormulaOf(dimension="force", coordinates=True, velocities=True)]
TorqueOfMotion = Annotated[Formula, FormulaOf(dimension="torque", coordinates=True, velocities=True)]
"""Force or torque as a formula of coordinates, velocities and time."""
ForceOfDeflection = Annotated[Formula | Table, FormulaOf(("s",), ("length",), "force", time=False, table=True)]
TorqueOfDeflection = Annotated[Formula | Table, FormulaOf(("s",), ("angle",), "torque", time=False, table=True)]
"""Force or torque as a formula or a table of a deflection s."""
ForceOfRate = Annotated[Formula | Table, FormulaOf(("v",), ("velocity",), "force", time=False, table=True)]
TorqueOfRate = Annotated[Formula | Table, FormulaOf(("v",), ("angular velocity",), "torque", time=False, table=True)]
"""Force or torque as a formula or a table of a rate v."""
