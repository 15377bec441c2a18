"""The requests of a model in space as a field: text to checked formulas."""

from __future__ import annotations

import ast
from numbers import Real
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..body import check_names
from ..files.quoted import written
from ..formula import measured
from ..formula.field import FormulaOf, called_tables
from ..formula.full_names import text_in_full, with_full_names
from ..formula.functions import FUNCTIONS, check_functions
from ..formula.text import FormulaError, as_written, parse
from ..formula.variables import with_variables
from ..marker import GROUND, MarkerReference
from ..parts.names import names_of
from ..units.units import Quantity
from .output import ACTIONS, ALONG_AXES, MEASURES, Output, Term, placeholder


class _Terms(ast.NodeTransformer):
    """Takes measures and actions out of a tree."""

    def __init__(self) -> None:
        self.found: list[Term] = []

    def visit_Call(self, node: ast.Call) -> ast.AST:
        name = node.func.id  # type: ignore[attr-defined]
        if name in MEASURES:
            term = self._measure(name, node)
        elif name in ACTIONS:
            term = self._action(name, node)
        else:
            return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])
        self.found.append(term)
        return ast.Name(placeholder(len(self.found) - 1))

    @staticmethod
    def _measure(name: str, node: ast.Call) -> Term:
        markers = [_marker(argument) for argument in node.args]
        most = 3 if name in ALONG_AXES else 2
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
    """A joint or force, and which of its ends is meant, if any."""
    owner, name = _owner_and_name(node)
    return (f"{owner}.{name}", "") if name not in ("", "i", "j") else (owner, name)


def _owner_and_name(node: ast.expr) -> tuple[str, str]:
    match node:
        case ast.Name(name):
            return name, ""
        case ast.Attribute(ast.Name(owner), name):
            return owner, name
    raise FormulaError(f"found '{ast.unparse(node)}', expected a name such as bar.end")


class OutputField:
    """Marks a field as the formula of a request."""

    def read(self, found: Any, info: ValidationInfo) -> Output:
        """The checked formula of what stands in the scene."""
        if isinstance(found, Output):
            return found
        if isinstance(found, Real) and not isinstance(found, bool):
            found = repr(float(found))
        if not isinstance(found, str):
            raise FormulaError(f"found {written(found)}, expected a formula")
        terms = _Terms()
        context = info.context or {}
        variables = context.get("variables") or {}
        named = with_full_names(parse(found), names_of(info), (*MEASURES, *ACTIONS))
        found = text_in_full(found, named, names_of(info))
        whole = with_variables(named, variables)
        expanded = as_written(whole) if variables else ""
        tree = terms.visit(whole)
        tables = context.get("tables") or {}
        check_functions(tree, FUNCTIONS, tables=tuple(tables), listed=(*MEASURES, *ACTIONS))
        places = {placeholder(k): measured.MEASURES[term.function] for k, term in enumerate(terms.found)}
        parameters = context.get("parameters") or {}
        quantities = _NAMES.quantities(found, tree, parameters | dict.fromkeys(places, Quantity(0.0)))
        used = {name: quantity for name, quantity in quantities if name not in places}
        called = called_tables(tree, tables)
        _NAMES.dimension_of(tree, used, called, places)
        values = {name: quantity.value for name, quantity in used.items()}
        own = {name: quantity for name, quantity in used.items() if name in parameters}
        return Output(found, tree, tuple(terms.found), values, called, own, expanded)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        text = {"type": "string", "description": "a formula of anything that a run knows"}
        return {"anyOf": [text, {"type": "number"}]}


_NAMES = FormulaOf(coordinates=True, velocities=True)


class _RequestedField(OutputField):
    """Marks a field as the formula of a request, or formulas by the names of their components."""

    def read(self, found: Any, info: ValidationInfo) -> Any:
        if not isinstance(found, dict):
            return super().read(found, info)
        if not found:
            raise FormulaError("found {}, expected a formula, or formulas by the names of their components")
        check_names(found, "component")
        formulas = {}
        for name, formula in found.items():
            try:
                formulas[name] = super().read(formula, info)
            except FormulaError as error:
                raise FormulaError(f"{name}: {error}") from None
        return formulas

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        one = super().__get_pydantic_json_schema__(schema, handler)
        return {"anyOf": [*one["anyOf"], {"type": "object", "additionalProperties": one}]}


Requested = Annotated[Output | dict[str, Output], _RequestedField()]
"""A formula of anything that a run knows, or several by name."""
