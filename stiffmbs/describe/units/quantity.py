"""Reading numbers with units: ``125 mm``, ``20 deg``, ``0.6/2``, all turned to SI with their dimension checked."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from typing import Any

from ..files.quoted import quoted, written
from ..formula.text import UNIT, FormulaError, evaluate, parse
from .units import ANY, CONSTANTS, DIMENSIONS, NUMBER, UNITS, Quantity, in_units, one

LARGEST = 1e100
"""In SI units; products of three such numbers overflow."""


def _of_number(function: Callable[..., float]) -> Callable[..., Quantity]:
    def call(*arguments: Quantity) -> Quantity:
        if any(a.dimension not in (None, NUMBER) for a in arguments):
            raise FormulaError(
                f"found {function.__name__} of a quantity with a unit, expected a plain number or an angle"
            )
        return Quantity(function(*(a.value for a in arguments)))

    return call


def _sqrt(a: Quantity) -> Quantity:
    return a ** Quantity(0.5)


def _abs(a: Quantity) -> Quantity:
    return Quantity(abs(a.value), a.dimension)


def _of_same(choose: Callable[..., float]) -> Callable[..., Quantity]:
    def call(first: Quantity, *others: Quantity) -> Quantity:
        total = first
        for other in others:
            total = total + other  # refuses mixed units
        return Quantity(choose(*(a.value for a in (first, *others))), total.dimension)

    return call


def _atan2(y: Quantity, x: Quantity) -> Quantity:
    return Quantity(math.atan2(y.value, x.value), (y - x).dimension and NUMBER)


_PLAIN = (
    math.sin,
    math.cos,
    math.tan,
    math.asin,
    math.acos,
    math.atan,
    math.sinh,
    math.cosh,
    math.tanh,
    math.exp,
    math.log,
)
FUNCTIONS: dict[str, Callable[..., Quantity]] = {
    **{f.__name__: _of_number(f) for f in _PLAIN},
    "sqrt": _sqrt,
    "atan2": _atan2,
    "abs": _abs,
    "min": _of_same(lambda *values: min(values)),
    "max": _of_same(lambda *values: max(values)),
}


def quantity(text: str, parameters: Mapping[str, Quantity] | None = None) -> Quantity:
    """Evaluate arithmetic with units.

    Parameters
    ----------
    text : str
        Such as ``"125 mm"``, ``"0.6/2"``, ``"2*sin(20 deg)"``.
    parameters : mapping, optional
        The scene's own names.

    Raises
    ------
    FormulaError
        For an unknown name or function, mixed units, or a value that is not finite.
    """
    known = parameters or {}
    tree = parse(text)
    with_units = any(isinstance(node, ast.Attribute) for node in ast.walk(tree))

    def names(name: str) -> Quantity:
        owner, _, unit = name.rpartition(".")
        if owner == UNIT and unit in UNITS:
            return UNITS[unit]
        name = unit if owner == UNIT else name
        if name in known and name in UNITS and with_units:
            raise FormulaError(
                f"found '{name}' in '{quoted(text)}', which is a unit and a parameter of the scene, expected one or the other"
            )
        for table in (known, UNITS, CONSTANTS):
            if name in table:
                return table[name]
        listed = ", ".join(known) if known else "none"
        raise FormulaError(
            f"found the unknown name '{name}', expected a unit, pi or a parameter of the scene ({listed})"
        )

    try:
        result: Quantity = evaluate(tree, names, FUNCTIONS, lambda value: Quantity(float(value)))
    except ArithmeticError:
        raise FormulaError(f"found '{quoted(text)}', which divides by zero or overflows") from None
    except ValueError as error:
        if isinstance(error, FormulaError):
            raise
        raise FormulaError(f"found '{quoted(text)}', which has no real value") from None
    if not math.isfinite(result.value):
        raise FormulaError(f"found '{quoted(text)}', which is not a finite number")
    return result


def in_si(found: object, dimension: str, parameters: Mapping[str, Quantity] | None = None) -> float:
    """Turn what stands in a scene (a number or text) into a finite SI value of the named dimension."""
    expected, unit = DIMENSIONS[dimension]
    if isinstance(found, str):
        result = quantity(found, parameters)
        if dimension != ANY and result.dimension is not None and result.dimension != expected:
            raise FormulaError(
                f"found '{quoted(found)}', which is in {in_units(result.dimension)}, expected {one(dimension)} in {unit}"
            )
        return _of_ordinary_size(result.value, dimension)
    if isinstance(found, bool) or not hasattr(found, "__float__") or getattr(found, "ndim", False):
        raise FormulaError(f"found {_shown(found)}, expected {one(dimension)} in {unit}")
    value = as_float(found)
    if not math.isfinite(value):
        raise FormulaError(f"found {value}, expected a finite {dimension} in {unit}")
    return _of_ordinary_size(value, dimension)


def as_float(found: Any) -> float:
    """A number in floating point; errors as `in_si`, for a whole number beyond 1e308."""
    try:
        return float(found)
    except OverflowError:
        raise FormulaError(f"found a {type(found).__name__} beyond 1e308, expected a smaller number") from None


def _of_ordinary_size(value: float, dimension: str) -> float:
    """The value, if its square and its products with others are still numbers."""
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
