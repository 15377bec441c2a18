"""Requests in space: formulas that are only reported, of everything that a run knows.

Besides what the formulas of elements may hold (`stiffmbs.describe.formula_names.SPACE`) they measure accelerations and
angles, ask for what joints and forces do, and read other channels.  They are evaluated after the run, so that none of
them is compiled.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..body import check_names
from ..element import JointName
from ..formula import FormulaError, parse
from ..formula_field import FormulaOf, called_tables
from ..formula_functions import FUNCTIONS, OF_TABLE, ROUNDING, check_functions
from ..formula_names import SPACE
from ..marker import GROUND, MarkerReference
from ..model_data import ModelData, check_marker
from ..table import Table

ACCELERATIONS = ("accx", "accy", "accz", "accm", "wdtx", "wdty", "wdtz", "wdtm")
ANGLES = ("psi", "theta", "phi", "q0", "q1", "q2", "q3")
"""Body-fixed turns about z, x and z, and the quaternion, of one marker against another."""
MEASURES = tuple(dict.fromkeys((*SPACE.position_measures, *SPACE.velocity_measures, *ACCELERATIONS, *ANGLES)))
"""Between two markers, those of `ALONG_AXES` perhaps along the axes of a third."""
ALONG_AXES = (*SPACE.along_axes, "accx", "accy", "accz", "wdtx", "wdty", "wdtz")
ACTIONS = ("fx", "fy", "fz", "fm", "tx", "ty", "tz", "tm")
"""Force and torque of a joint or force on its first body, or on its second (``hinge.j``), along ground axes or those of a
marker: ``fx(hinge)``, ``tz(hinge.j, bar.end)``; fm and tm are their sizes."""

OF_BODIES = (*SPACE.positions, *SPACE.velocities, "ax", "ay", "az", "wdx", "wdy", "wdz")
OF_ELEMENTS = ("fx", "fy", "fz", "tx", "ty", "tz")
"""The channels that a formula may read."""


@dataclass(frozen=True)
class Term:
    """A measure or an action in a formula.

    Attributes
    ----------
    function : str
        One of `MEASURES` or `ACTIONS`.
    element : str
        Of an action: the joint or force.
    on_second : bool
        Whether what it does to its second body is meant.
    markers : tuple of MarkerReference
        Of a measure i and j, and the marker whose axes it is along, if any; of an action that marker alone, if any.
    """

    function: str
    element: str
    on_second: bool
    markers: tuple[MarkerReference, ...]


@dataclass(frozen=True, eq=False)
class Output:
    """A checked formula of a request.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its tree with the names ``term0``, ``term1`` ... in place of `terms`.
    terms : tuple of Term
    values : mapping of str to float
        The scene's parameters, units and constants that it uses, in SI units.
    tables : mapping of str to Table
        The scene's tables that it calls.
    """

    text: str
    tree: ast.expr
    terms: tuple[Term, ...]
    values: Mapping[str, float]
    tables: Mapping[str, Table]

    def channels(self) -> Iterator[tuple[str, str]]:
        """The channels that it reads, as (owner, component)."""
        for node in ast.walk(self.tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if f"{owner}.{name}" not in self.values:
                    yield owner, name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Output) and (self.text, self.values) == (other.text, other.values)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Output({self.text!r})"


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
        return ast.Name(f"term{len(self.found) - 1}")

    @staticmethod
    def _measure(name: str, node: ast.Call) -> Term:
        markers = [MarkerReference.model_validate(_reference(argument)) for argument in node.args]
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
        element, _, end = _reference(node.args[0]).partition(".")
        if end not in ("", "i", "j"):
            raise FormulaError(
                f"found '{element}.{end}' in '{ast.unparse(node)}', expected {element}, {element}.i or {element}.j"
            )
        markers = tuple(MarkerReference.model_validate(_reference(argument)) for argument in node.args[1:])
        return Term(name, element, end == "j", markers)


def _reference(node: ast.expr) -> str:
    match node:
        case ast.Name(name):
            return name
        case ast.Attribute(ast.Name(owner), name):
            return f"{owner}.{name}"
    raise FormulaError(f"found '{ast.unparse(node)}', expected a name such as bar.end")


class _OutputField:
    """Marks a field as the formula of a request."""

    def read(self, found: Any, info: ValidationInfo) -> Output:
        """The checked formula of what stands in the scene."""
        if isinstance(found, Output):
            return found
        if isinstance(found, Real) and not isinstance(found, bool):
            found = repr(float(found))
        if not isinstance(found, str):
            raise FormulaError(f"found {found!r}, expected a formula")
        terms = _Terms()
        tree = terms.visit(parse(found))
        tables = (info.context or {}).get("tables") or {}
        known = FUNCTIONS | ROUNDING | dict.fromkeys(tables, OF_TABLE)
        check_functions(tree, known, (), (*known, *MEASURES, *ACTIONS))
        places = {f"term{k}": 0.0 for k in range(len(terms.found))}
        parameters = {name: value.value for name, value in ((info.context or {}).get("parameters") or {}).items()}
        values = _NAMES.values(found, tree, parameters | places)
        return Output(
            found,
            tree,
            tuple(terms.found),
            {name: v for name, v in values if name not in places},
            called_tables(tree, tables),
        )

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        text = {"type": "string", "description": "a formula of anything that a run knows"}
        return {"anyOf": [text, {"type": "number"}]}


_NAMES = FormulaOf(coordinates=True, velocities=True)


class _RequestedField(_OutputField):
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


def ends(element: str, model: ModelData) -> tuple[Any, Any]:
    """The markers i and j of a joint or force, of a drive those of the joint that it drives; None where it has none."""
    acting: Any = {**model.joints, **model.forces}[element]
    for _, joint in acting.parts(JointName):
        acting = model.joints[joint.joint]
        break
    return getattr(acting, "i", None), getattr(acting, "j", None)


def check_output(where: str, output: Output, model: ModelData) -> None:
    """Refuse a formula that names an unknown body, marker, joint, force or channel."""
    acting = {**model.joints, **model.forces}
    for term in output.terms:
        for marker in term.markers:
            check_marker(where, marker, model.bodies, model.markers)
        if term.element and term.element not in acting:
            raise ValueError(f"{where}: found '{term.element}' in '{output.text}', expected a joint or a force")
        if term.on_second and None in ends(term.element, model):
            raise ValueError(f"{where}: found '{term.element}.j' in '{output.text}', which has no marker j")
    for owner, name in output.channels():
        known = OF_BODIES if owner in model.bodies else OF_ELEMENTS if owner in acting else ()
        if name not in known:
            raise ValueError(
                f"{where}: found '{owner}.{name}' in '{output.text}', expected a channel of a body, a joint or a force"
            )
