"""Fields for requests: from text to checked formulas."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Annotated, Any

from ...errors import prefixed
from ...reading.formula.field import FormulaOf, formula_text
from ...reading.formula.formula import called_tables
from ...reading.formula.full_names import text_in_full, with_full_names
from ...reading.formula.functions import FUNCTIONS, check_functions
from ...reading.formula.nodes import TIME, reading_order
from ...reading.formula.text import FormulaError, as_written, parse
from ...reading.formula.variables import with_variables
from ...reading.marker import GROUND, MarkerReference
from ...reading.names import Names
from ...reading.units.units import CONSTANTS, UNITS, Quantity
from ..body import check_names
from ..read_by import Context, ReadBy
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
        element, end = _owner_and_name(node.args[0])
        full = f"{element}.{end}" if end not in ("", "i", "j") else element
        return Term(name, full, end == "j", tuple(_marker(argument) for argument in node.args[1:]))


def _marker(node: ast.expr) -> MarkerReference:
    body, name = _owner_and_name(node)
    return MarkerReference(body=body, marker=name or None)


def _owner_and_name(node: ast.expr) -> tuple[str, str]:
    match node:
        case ast.Name(name):
            return name, ""
        case ast.Attribute(ast.Name(owner), name):
            return owner, name
    raise FormulaError(f"found '{ast.unparse(node)}', expected a name such as bar.end")


_NAMES = FormulaOf(coordinates=True, velocities=True)


def read_output(family: OutputNames, found: object, context: Context) -> object:
    """Return the checked formula of an entry, with its parameters and tables. Raises FormulaError."""
    if isinstance(found, Output):
        return found
    given = formula_text(found)
    terms = _Terms(family)
    variables = (context or {}).get("variables") or {}
    names = (context or {}).get("names") or Names()
    takers = (*family.measures, *family.actions)
    named = with_full_names(parse(given), names, takers)
    whole = with_variables(named, variables)
    shown = text_in_full(given, named, names)
    text = text_in_full(given, with_variables(named, names.values), names)
    expanded = as_written(with_variables(whole, names.values)) if variables else ""
    tree = terms.visit(whole)
    tables = (context or {}).get("tables") or {}
    check_functions(tree, FUNCTIONS, tables=tuple(tables), listed=takers)
    parameters: Mapping[str, Quantity] = (context or {}).get("parameters") or {}
    others = set(_others(tree, parameters))
    known = {**parameters, **dict.fromkeys(others, Quantity(0.0))}
    used = dict(_NAMES.quantities(shown, tree, known))
    if names.values:
        tree = with_variables(tree, names.values)
        used = dict(_NAMES.quantities(text, tree, known))
    used = {name: quantity for name, quantity in used.items() if name not in others}
    own = {name: quantity for name, quantity in used.items() if name in parameters}
    return Output(text, tree, tuple(terms.found), used, called_tables(tree, tables), own, expanded)


def _others(tree: ast.expr, parameters: Mapping[str, Quantity]) -> Iterator[str]:
    """Yield the undotted names that are not parameters, units, constants or time: terms and other requests."""
    for node in reading_order(tree):
        match node:
            case ast.Name(name) if name != TIME and not any(name in known for known in (parameters, UNITS, CONSTANTS)):
                yield name


def read_request(family: OutputNames, found: object, context: Context) -> Any:
    """Return the formula of a request, or several by component; errors as for `read_output`."""
    if not isinstance(found, Mapping):
        return read_output(family, found, context)
    if not found:
        raise FormulaError("found {}, expected a formula, or formulas by the names of their components")
    check_names(found, "component")
    for name in ("formula", "expression", "unit", "units"):
        if name in found:
            raise FormulaError(
                f"found the component '{name}', expected a formula, whose unit follows, or formulas by the names of their components"
            )
    formulas = {}
    for name, formula in found.items():
        with prefixed(f"{name}: ", FormulaError, FormulaError):
            formulas[name] = read_output(family, formula, context)
    return formulas


_FORMULA = [{"type": "string", "description": "a formula of any quantities of a run"}, {"type": "number"}]


def output_field(family: OutputNames) -> ReadBy:
    """Return the marker of a field for a formula of a family of models."""
    return ReadBy(partial(read_output, family), lambda _: {"anyOf": _FORMULA})


def request_field(family: OutputNames) -> ReadBy:
    """Return the marker of a field for the formula of a request, or for several by component."""
    several = {"type": "object", "additionalProperties": {"anyOf": _FORMULA}}
    return ReadBy(partial(read_request, family), lambda _: {"anyOf": [*_FORMULA, several]})


PlanarRequest = Annotated[Output | dict[str, Output], request_field(OF_PLANE)]
SpatialRequest = Annotated[Output | dict[str, Output], request_field(OF_SPACE)]
"""Formula for a request, or several by name."""
