"""A formula of body coordinates, time and the scene's parameters, as a field of an element."""

from __future__ import annotations

import ast
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from .formula import UNIT, FormulaError, parse
from .quantity import CONSTANTS, UNITS

TIME = "t"
COORDINATES = ("x", "y", "angle")
FUNCTIONS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs",
)  # fmt: skip


class Formula:
    """A checked formula.

    Attributes
    ----------
    text : str
        As written.
    tree : ast.expr
        Its syntax tree (`stiffmbs.describe.formula.parse`).
    bodies : tuple of str
        The bodies whose coordinates it uses, in order of appearance.
    values : dict of str to float
        The scene's parameters, units and constants that it uses, in SI units.
    """

    def __init__(self, text: str, parameters: dict[str, float] | None = None) -> None:
        self.text = text
        self.tree = parse(text)
        self.bodies: tuple[str, ...] = ()
        self.values: dict[str, float] = {}
        known = parameters or {}
        for node in _in_reading_order(self.tree):
            match node:
                case ast.Attribute(ast.Name(owner), name) if owner == UNIT:
                    self._use_unit(name)
                case ast.Attribute(ast.Name(body), coordinate):
                    self._use_coordinate(body, coordinate)
                case ast.Call(ast.Name(function)) if function not in FUNCTIONS:
                    raise FormulaError(
                        f"found the unknown function '{function}', expected one of {', '.join(FUNCTIONS)}"
                    )
                case ast.Name(name) if name not in FUNCTIONS and name != TIME:
                    self._use_value(name, known)

    def _use_coordinate(self, body: str, coordinate: str) -> None:
        if coordinate not in COORDINATES:
            raise FormulaError(f"found '{body}.{coordinate}', expected {body}.x, {body}.y or {body}.angle")
        if body not in self.bodies:
            self.bodies += (body,)

    def _use_unit(self, name: str) -> None:
        if name not in UNITS:
            raise FormulaError(f"found '{name}' after a number in '{self.text}', expected a unit")
        self.values[f"{UNIT}.{name}"] = UNITS[name].value

    def _use_value(self, name: str, known: dict[str, float]) -> None:
        if name in known:
            self.values[name] = known[name]
        elif name in UNITS:
            self.values[name] = UNITS[name].value
        elif name in CONSTANTS:
            self.values[name] = CONSTANTS[name].value
        else:
            raise FormulaError(
                f"found the unknown name '{name}' in '{self.text}', expected t, a body's coordinate such as cart.x, "
                "a unit, or a parameter of the scene"
            )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Formula) and (self.text, self.values) == (other.text, other.values)

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"Formula({self.text!r})"


def _in_reading_order(tree: ast.expr) -> list[ast.AST]:
    """All nodes but the owner's name in ``cart.x`` and the function's in ``sin(...)``."""
    found: list[ast.AST] = [tree]
    match tree:
        case ast.Attribute():
            return found
        case ast.Call(_, arguments):
            children: list[ast.AST] = list(arguments)
        case _:
            children = [child for child in ast.iter_child_nodes(tree) if isinstance(child, ast.expr)]
    for child in children:
        found += _in_reading_order(child)  # type: ignore[arg-type]
    return found


def as_formula(found: Any, parameters: dict[str, Any] | None = None) -> Formula:
    """Make a formula of text, a number, or a SymPy expression in the symbols that a `BodyHandle` gives."""
    if isinstance(found, Formula):
        return found
    known = {name: value.value for name, value in (parameters or {}).items()}
    if isinstance(found, str):
        return Formula(found, known)
    if isinstance(found, int | float) and not isinstance(found, bool):
        return Formula(repr(found), known)
    if hasattr(found, "free_symbols"):
        from sympy.printing.pycode import pycode

        return Formula(pycode(found, fully_qualified_modules=False), known)
    raise FormulaError(f"found {found!r}, expected a formula")


def _read(found: Any, info: ValidationInfo) -> Formula:
    return as_formula(found, (info.context or {}).get("parameters"))


FormulaField = Annotated[
    Formula,
    BeforeValidator(_read),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "number"}], "description": "a formula of coordinates and t"}
    ),
]
