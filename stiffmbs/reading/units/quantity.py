"""Reading of numbers with units: ``125 mm``, ``20 deg``, ``0.6/2``, converted to SI with a check of the dimension."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from ..did_you_mean import did_you_mean
from ..files.quoted import quoted, written
from ..formula.functions import FUNCTIONS, IN_NUMBERS, check_functions
from ..formula.measured import dimension_of
from ..formula.text import OF_NUMBERS, TEXTS, UNIT, FormulaError, evaluate, parse
from .units import ANY, CONSTANTS, DIMENSIONS, UNITS, Quantity, in_its_unit, one, unit_of_spelling

LARGEST = 1e100
"""Largest number, in SI units; products of three such numbers do not overflow."""


@lru_cache(maxsize=TEXTS)
def _parsed(text: str) -> tuple[ast.expr, tuple[str, ...]]:
    """Return the read-only tree of a text, and the names in it."""
    tree = parse(text)
    check_functions(tree, IN_NUMBERS)
    names = (getattr(node, "id", None) or getattr(node, "attr", None) for node in ast.walk(tree))
    return tree, tuple(sorted(set(filter(None, names))))


def _named(text: str, tree: ast.expr, known: Mapping[str, Quantity]) -> Callable[[str], Quantity]:
    def named(name: str) -> Quantity:
        """Return the quantity of a unit, constant or other name."""
        owner, _, last = name.rpartition(".")
        if owner == UNIT:
            for table in (UNITS, known, CONSTANTS):
                if last in table:
                    return table[last]
        return of_name(last if owner == UNIT else name, text, tree, known)

    return named


def quantity(text: str, parameters: Mapping[str, Quantity] | None = None) -> Quantity:
    """Evaluate arithmetic with units, such as ``"125 mm"`` or ``"2*sin(20 deg)"``, with parameters of the scene.

    Raises FormulaError for an unknown name or function, mixed units, or a value that is not finite.
    """
    known = parameters or {}
    used = tuple((name, known[name]) for name in _parsed(text)[1] if name in known)
    try:
        return _evaluated(text, used)
    except FormulaError:
        return _evaluated.__wrapped__(text, tuple(known.items()))  # the message lists all parameters


@lru_cache(maxsize=TEXTS)
def _evaluated(text: str, parameters: tuple[tuple[str, Quantity], ...]) -> Quantity:
    """Return the value of a text, cached because studies read the same texts with the same parameters repeatedly."""
    tree = _parsed(text)[0]
    named = _named(text, tree, dict(parameters))
    dimension = dimension_of(tree, named)
    try:
        value = evaluate(tree, lambda name: named(name).value, VALUES, float, OF_NUMBERS)
    except ArithmeticError:
        raise FormulaError(f"found '{quoted(text)}', which divides by zero or overflows") from None
    except ValueError as error:
        if isinstance(error, FormulaError):
            raise
        raise FormulaError(f"found '{quoted(text)}', which has no real value") from None
    if not math.isfinite(value):
        raise FormulaError(f"found '{quoted(text)}', which is not a finite number")
    return Quantity(float(value), dimension.exponents if dimension.stated else None)


def is_unit(node: ast.AST) -> bool:
    """Return True for a unit, a name after a number in a formula."""
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == UNIT


def _is_number_with_units(node: ast.expr) -> bool:
    """Return True for one number that is followed by units alone, such as ``-1e8 N/m``."""
    match node:
        case ast.UnaryOp(_, operand):
            return _is_number_with_units(operand)
        case ast.BinOp(left, ast.Mult() | ast.Div(), right):
            return _is_number_with_units(left) and _is_of_units(right)
    return isinstance(node, ast.Constant)


def _is_of_units(node: ast.expr) -> bool:
    match node:
        case ast.Name(name):
            return name in UNITS
        case ast.BinOp(left, ast.Mult() | ast.Div(), right):
            return _is_of_units(left) and _is_of_units(right)
        case ast.BinOp(base, ast.Pow(), exponent):
            return _is_of_units(base) and not any(isinstance(part, ast.Name) for part in ast.walk(exponent))
    return is_unit(node)


def of_name(
    name: str, text: str, tree: ast.expr, parameters: Mapping[str, Quantity], units: Mapping[str, Quantity] = UNITS
) -> Quantity:
    """Return the meaning of an undotted name in a formula: a parameter, a unit or a constant.

    A name that is a parameter and a unit is a unit in a number with units alone: m in ``1e8 N/m``. Raise a FormulaError for
    one next to other units in a formula, and for an unknown name.
    """
    if name in parameters and name in UNITS and any(map(is_unit, ast.walk(tree))):
        if _is_number_with_units(tree):
            return UNITS[name]
        raise FormulaError(
            f"found '{name}' in '{quoted(text)}', which is a unit and a parameter of the scene, expected one or the other: "
            f"rename the parameter, or write (1 {name}) for the unit"
        )
    for table in (parameters, units, CONSTANTS):
        if name in table:
            return table[name]
    listed = ", ".join(parameters) if parameters else "none"
    unit = unit_of_spelling(name)
    of_units = f" (did you mean '{unit}'?)" if unit else did_you_mean(name, units)
    near = did_you_mean(name, parameters) or of_units
    raise FormulaError(
        f"found the unknown name '{name}'{near}, expected a unit, pi or a parameter of the scene ({listed})"
    )


VALUES: dict[str, Callable[..., float]] = {name: function.value for name, function in FUNCTIONS.items()}
"""Functions of plain numbers."""


def refuse_cycles(text: str, tree: ast.expr) -> None:
    """Raise a FormulaError for an angular velocity in Hz, which is 1/s: 50 Hz would be 50 rad/s."""
    words = {part.id for part in ast.walk(tree) if isinstance(part, ast.Name)}
    words |= {part.attr for part in ast.walk(tree) if is_unit(part)}  # type: ignore[attr-defined]
    if words & {"Hz", "kHz"} and not words & {"pi", "rev", "rad", "deg"}:
        raise FormulaError(f"found Hz in '{quoted(text)}', which is 1/s, expected rad/s, rpm, or Hz times 2*pi")


def in_si(found: object, dimension: str, parameters: Mapping[str, Quantity] | None = None) -> float:
    """Convert an entry of a scene (a number or text) to a finite SI value of the named dimension."""
    expected, unit = DIMENSIONS[dimension]
    if isinstance(found, str):
        result = quantity(found, parameters)
        if dimension == "angular velocity":
            refuse_cycles(found, _parsed(found)[0])
        if dimension != ANY and result.dimension is not None and result.dimension != expected:
            raise FormulaError(
                f"found '{quoted(found)}', which is {in_its_unit(result.dimension)}, expected {one(dimension)} in {unit}"
            )
        return _of_ordinary_size(result.value, dimension)
    if isinstance(found, bool) or not hasattr(found, "__float__") or getattr(found, "ndim", False):
        raise FormulaError(f"found {_shown(found)}, expected {one(dimension)} in {unit}")
    value = as_float(found)
    if not math.isfinite(value):
        raise FormulaError(f"found {value}, expected a finite {dimension} in {unit}")
    return _of_ordinary_size(value, dimension)


def as_float(found: Any) -> float:
    """Convert to floating point; errors as `in_si`, for an integer beyond 1e308."""
    try:
        return float(found)
    except OverflowError:
        raise FormulaError(f"found a {type(found).__name__} beyond 1e308, expected a smaller number") from None


def _of_ordinary_size(value: float, dimension: str) -> float:
    """Return the value, or refuse it if products of it could overflow."""
    if abs(value) > LARGEST:
        raise FormulaError(
            f"found {value:g}, expected {one(dimension)} below {LARGEST:g} {DIMENSIONS[dimension][1]}".rstrip()
        )
    return value


def _shown(found: object) -> str:
    if found is None:
        return "nothing"
    if isinstance(found, bool):
        return "yes or no (a truth value)"
    if isinstance(found, dict):
        return "a mapping"
    return "a list" if isinstance(found, list | tuple) or hasattr(found, "ndim") else written(found)
