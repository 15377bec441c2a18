"""Dimension of a formula, derived from the dimensions of its parts."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import Any

from ..units.units import ANY, DIMENSIONS, Quantity, named_unit, one
from .dimension import PLAIN, Known, alike, known_of, power, product
from .functions import FUNCTIONS
from .text import OF_NUMBERS, FormulaError, evaluate

Named = Callable[[str], Quantity | Known]
"""Function from a name, such as ``L``, ``unit.kg`` or ``cart.x``, to its value or known dimension."""

Columns = tuple[Known, Known]
NONE: Mapping[str, Any] = {}


def dimension_of(
    tree: ast.expr, named: Named, measures: Mapping[str, Known] = NONE, tables: Mapping[str, Columns] = NONE
) -> Known:
    """Return the dimension of a checked syntax tree with functions of markers and tables of these dimensions.

    Raises FormulaError for a sum of different dimensions, and for an argument of the wrong dimension.
    """

    def of(node: ast.expr) -> Known:
        return dimension_of(node, named, measures, tables)

    match tree:
        case ast.Name(name):
            return _known(named(name))
        case ast.Attribute(ast.Name(owner), name):
            return _known(named(f"{owner}.{name}"))
        case ast.UnaryOp(_, operand):
            return of(operand)
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            return alike(((of(left), left), (of(right), right)), tree)
        case ast.BinOp(left, ast.Pow(), right):
            return power(of(left), (of(right), right), _value(right, named))
        case ast.BinOp(left, op, right):
            return product(of(left), of(right), -1 if isinstance(op, ast.Div) else 1)
        case ast.Call(ast.Name(name), arguments):
            if name in measures:
                return measures[name]
            given = [(of(part), part) for part in arguments]
            if name in tables:
                argument, value = tables[name]
                alike((*given, (argument, tree)), tree)
                return value
            return FUNCTIONS[name].dimension(given, tree)
    return PLAIN


def _known(found: Quantity | Known) -> Known:
    return known_of(found) if isinstance(found, Quantity) else found


def _value(node: ast.expr, named: Named) -> float | None:
    """Return the value of an exponent; None if it is not constant."""

    def value(name: str) -> float:
        found = named(name)
        if isinstance(found, Known):
            raise FormulaError(f"found '{name}', expected a number")
        return found.value

    try:
        result: float = evaluate(node, value, {name: f.value for name, f in FUNCTIONS.items()}, float, OF_NUMBERS)
    except (ArithmeticError, ValueError):
        return None
    return result


def check_dimension(what: str, found: Known, dimension: str) -> None:
    """Raise a FormulaError for a value with a unit of the wrong dimension; the message calls it `what`."""
    if dimension != ANY and not found.is_of(dimension):
        assert found.exponents is not None
        raise FormulaError(
            f"found {what} in {named_unit(found.exponents)}, expected {one(dimension)} in {DIMENSIONS[dimension][1]}"
        )
