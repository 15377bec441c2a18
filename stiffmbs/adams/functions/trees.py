"""Constructors of formula syntax trees."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence
from functools import reduce


def name_of(text: str) -> ast.expr:
    """Return a name, or ``owner.name``."""
    owner, _, name = text.partition(".")
    return ast.Attribute(ast.Name(owner), name) if name else ast.Name(owner)


def number(value: float) -> ast.expr:
    """Return a number; a negative one as a unary minus."""
    value = float(value)
    return ast.UnaryOp(ast.USub(), ast.Constant(-value)) if value < 0 else ast.Constant(value)


def call(name: str, *arguments: ast.expr) -> ast.expr:
    """Return a function call."""
    return ast.Call(ast.Name(name), list(arguments), [])


def product(left: ast.expr, right: ast.expr) -> ast.expr:
    """Return left * right."""
    return ast.BinOp(left, ast.Mult(), right)


def quotient(left: ast.expr, right: ast.expr) -> ast.expr:
    """Return left / right."""
    return ast.BinOp(left, ast.Div(), right)


def difference(left: ast.expr, right: ast.expr) -> ast.expr:
    """Return left - right."""
    return ast.BinOp(left, ast.Sub(), right)


def cross(a: Sequence[ast.expr], b: Sequence[ast.expr]) -> list[ast.expr]:
    """Return the vector a x b."""
    return [difference(product(a[k - 2], b[k - 1]), product(a[k - 1], b[k - 2])) for k in range(3)]


def magnitude(vector: Iterable[ast.expr]) -> ast.expr:
    """Return the square root of the sum of the components' squares."""
    return call("sqrt", total([power(part, 2) for part in vector]))


def power(base: ast.expr, exponent: int) -> ast.expr:
    """Return base**exponent."""
    return ast.BinOp(base, ast.Pow(), ast.Constant(exponent))


def total(terms: Sequence[ast.expr]) -> ast.expr:
    """Return the sum of one or more terms."""
    return reduce(lambda sum_, term: ast.BinOp(sum_, ast.Add(), term), terms)


def times(node: ast.expr, factor: float) -> ast.expr:
    """Return a multiple; the node itself for a factor of 1."""
    return node if factor == 1 else product(number(factor), node)


def over(node: ast.expr, divisor: float) -> ast.expr:
    """Return a quotient; the node itself for a divisor of 1."""
    return node if divisor == 1 else quotient(node, number(divisor))


def components(name: str, i: str, j: str, axes: str) -> list[ast.expr]:
    """Return the three components of a measure, as `measured`."""
    return [measured(name + axis, i, j, axes) for axis in "xyz"]


def measured(name: str, i: str, j: str, axes: str) -> ast.expr:
    """Return a measure of marker i relative to j (default ground) in the axes of a third marker (default ground)."""
    markers = [i, j or "ground", axes] if axes else [i, j] if j else [i]
    return ast.Call(ast.Name(name), [name_of(marker) for marker in markers], [])
