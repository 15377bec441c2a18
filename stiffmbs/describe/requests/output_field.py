"""Fields for requests: from text to checked formulas."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..body import check_names
from ..formula.field import FormulaOf, formula_text
from ..formula.formula import called_tables
from ..formula.full_names import text_in_full, with_full_names
from ..formula.functions import FUNCTIONS, check_functions
from ..formula.nodes import TIME, reading_order
from ..formula.state_names import with_states
from ..formula.text import FormulaError, as_written, parse
from ..formula.variables import with_variables
from ..marker import GROUND, MarkerReference
from ..parts.names import Names
from ..units.units import CONSTANTS, UNITS, Quantity
from .names import OF_PLANE, OF_SPACE, OutputNames
from .output import Output, Term, placeholder


class _Terms(ast.NodeTransformer):
    """Replace measures and actions in a tree by placeholders, and collect them."""

    def __init__(self, names: OutputNames) -> None:
        self._names = names
        self.found: list[Term] = []

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Return a placeholder for a measure or an action; other functions stay."""
        name = node.func.id  # type: ignore[attr-defined]
        if name in self._names.measures:
            term = self._measure(name, node)
        elif name in self._names.actions:
            term = self._action(name, node)
        else:
            return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])
        self.found.append(term)
        return ast.Name(placeholder(len(self.found) - 1))

    def _measure(self, name: str, node: ast.Call) -> Term:
        markers = [_marker(argument) for argument in node.args]
        most = 3 if name in self._names.along_axes else 2
        if not 1 <= len(markers) <= most:
            raise FormulaError(f"found {len(markers)} markers in '{ast.unparse(node)}', expected 1 to {most}")
        if len(markers) == 1:
            markers.append(MarkerReference(body=GROUND))
        return Term(name, "", False, tuple(markers))

    @staticmethod
    def _action(name: str, node: ast.Call) -> Term:
        if len(node.args) not in (1, 2):
            raise FormulaError(
                f"found {len(node.args)} names in '{ast.unparse(node)}', expected a joint or force, and a marker if its axes are meant"
            )
        element, end = _element_and_end(node.args[0])
        markers = tuple(_marker(argument) for argument in node.args[1:])
        return Term(name, element, end == "j", markers)


def _marker(node: ast.expr) -> MarkerReference:
    body, name = _owner_and_name(node)
    return MarkerReference(body=body, marker=name or None)


def _element_and_end(node: ast.expr) -> tuple[str, str]:
    """Return a joint or force, and which of its ends is meant, if any."""
    owner, name = _owner_and_name(node)
    return (f"{owner}.{name}", "") if name not in ("", "i", "j") else (owner, name)


def _owner_and_name(node: ast.expr) -> tuple[str, str]:
    match node:
        case ast.Name(name):
            return name, ""
        case ast.Attribute(ast.Name(owner), name):
            return owner, name
    raise FormulaError(f"found '{ast.unparse(node)}', expected a name such as bar.end")


@dataclass(frozen=True)
class OutputField:
    """Marker of a field for the formula of a request in a family of models."""

    names: OutputNames

    def read(self, found: Any, context: Mapping[str, Any]) -> Any:
        """Return the checked formula of an entry, with its parameters and tables.

        Raises
        ------
        FormulaError
        """
        if isinstance(found, Output):
            return found
        given = formula_text(found)
        terms = _Terms(self.names)
        variables = context.get("variables") or {}
        names = context.get("names") or Names()
        takers = (*self.names.measures, *self.names.actions)
        named = with_states(with_full_names(parse(given), names, takers), names, (), takers)
        whole = with_variables(named, variables)
        shown = text_in_full(given, named, names)
        text = text_in_full(given, with_variables(named, names.values), names)
        expanded = as_written(with_variables(whole, names.values)) if variables else ""
        tree = terms.visit(whole)
        tables = context.get("tables") or {}
        check_functions(tree, FUNCTIONS, tables=tuple(tables), listed=takers)
        parameters: Mapping[str, Quantity] = context.get("parameters") or {}
        others = set(_others(tree, parameters))
        known = {**parameters, **dict.fromkeys(others, Quantity(0.0))}
        used = dict(_NAMES.quantities(shown, tree, known))
        if names.values:
            tree = with_variables(tree, names.values)
            used = dict(_NAMES.quantities(text, tree, known))
        used = {name: quantity for name, quantity in used.items() if name not in others}
        own = {name: quantity for name, quantity in used.items() if name in parameters}
        return Output(text, tree, tuple(terms.found), used, called_tables(tree, tables), own, expanded)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        def read(found: Any, info: ValidationInfo) -> Any:
            return self.read(found, info.context or {})

        return core_schema.with_info_plain_validator_function(read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        text = {"type": "string", "description": "a formula of anything that a run knows"}
        return {"anyOf": [text, {"type": "number"}]}


def _others(tree: ast.expr, parameters: Mapping[str, Quantity]) -> Iterator[str]:
    """Yield the undotted names that are not parameters, units, constants or time: terms and other requests."""
    for node in reading_order(tree):
        match node:
            case ast.Name(name) if name != TIME and not any(name in known for known in (parameters, UNITS, CONSTANTS)):
                yield name


_NAMES = FormulaOf(coordinates=True, velocities=True)


class RequestField(OutputField):
    """Marker of a field for the formula of a request, or for several by component."""

    def read(self, found: Any, context: Mapping[str, Any]) -> Any:
        """Return one formula, or several by name."""
        if not isinstance(found, Mapping):
            return super().read(found, context)
        if not found:
            raise FormulaError("found {}, expected a formula, or formulas by the names of their components")
        check_names(found, "component")
        formulas = {}
        for name, formula in found.items():
            try:
                formulas[name] = super().read(formula, context)
            except FormulaError as error:
                raise FormulaError(f"{name}: {error}") from None
        return formulas

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        one = super().__get_pydantic_json_schema__(schema, handler)
        return {"anyOf": [*one["anyOf"], {"type": "object", "additionalProperties": one}]}


PlanarRequest = Annotated[Output | dict[str, Output], RequestField(OF_PLANE)]
SpatialRequest = Annotated[Output | dict[str, Output], RequestField(OF_SPACE)]
"""Formula for a request, or several by name."""
