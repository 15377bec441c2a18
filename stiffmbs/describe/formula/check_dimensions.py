"""The dimension of a formula, from those of what it is made of."""

from __future__ import annotations

import ast
from collections.abc import Callable

from ..files.quoted import quoted
from ..units.units import ANY, DIMENSIONS, Quantity, named_unit, one
from .dimension import PLAIN, Known, alike, known_of, power, product
from .functions import FUNCTIONS
from .text import OF_NUMBERS, FormulaError, evaluate

Named = Callable[[str], Quantity | Known]
"""From a name, such as ``L``, ``unit.kg`` or ``cart.x``, to its value, or to what is known of its dimension."""


def dimension_of(tree: ast.expr, named: Named, called: Callable[[ast.Call], Known | None]) -> Known:
    """The dimension of a checked tree.

    Parameters
    ----------
    tree : ast.expr
        From `stiffmbs.describe.formula.text.parse`.
    named : callable
    called : callable
        Of a measure's or a table's value; None for a call of a function.

    Raises
    ------
    FormulaError
        For a sum of different dimensions, and for a function of one that it does not take.
    """

    def of(node: ast.expr) -> Known:
        return dimension_of(node, named, called)

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
            found = called(tree)
            return FUNCTIONS[name].dimension([(of(part), part) for part in arguments], tree) if found is None else found
    return PLAIN


def _known(found: Quantity | Known) -> Known:
    return known_of(found) if isinstance(found, Quantity) else found


def _value(node: ast.expr, named: Named) -> float | None:
    """The value of an exponent; None for one that is not constant."""

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


def check_dimension(text: str, found: Known, dimension: str) -> None:
    """Refuse a value with a unit that does not fit.

    Raises
    ------
    FormulaError
    """
    if dimension != ANY and not found.is_of(dimension):
        assert found.exponents is not None
        raise FormulaError(
            f"found '{quoted(text)}', which is in {named_unit(found.exponents)}, expected {one(dimension)} in "
            f"{DIMENSIONS[dimension][1]}"
        )
