"""Bounds on the size of a formula: number of parts and depth of nesting."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterator, Sequence

from ..files.quoted import quoted

MOST_PARTS = 2000
"""Largest number of numbers, names and operations in a formula, with its variables."""
DEEPEST = 60
"""Largest depth of nested operations and functions, after long sums and products have been balanced."""
CHAINS: dict[type[ast.operator], tuple[type[ast.operator], type[ast.operator]]] = {
    ast.Add: (ast.Add, ast.Sub), ast.Sub: (ast.Add, ast.Sub), ast.Mult: (ast.Mult, ast.Div), ast.Div: (ast.Mult, ast.Div),
}  # fmt: skip
"""Direct and inverse operator of the chain that an operator belongs to."""


class FormulaError(ValueError):
    """Formula that cannot be read or evaluated; the message follows the location of the formula."""


def parts(tree: ast.expr) -> int:
    """Return the number of numbers, names and operations in a formula."""
    return sum(map(len, _levels(tree)))


def depth(tree: ast.expr) -> int:
    """Return the depth of nesting of a formula."""
    return sum(1 for _ in _levels(tree)) - 1


def within(tree: ast.expr) -> Iterator[ast.expr]:
    """Yield the parts of a formula, outer ones first."""
    return itertools.chain.from_iterable(_levels(tree))


def _levels(tree: ast.expr) -> Iterator[list[ast.expr]]:
    level = [tree]
    while level:
        yield level
        level = [child for node in level for child in children(node)]


def children(node: ast.expr) -> list[ast.expr]:
    """Return the operands of an operation, or the arguments of a function; none for any other part of a formula."""
    match node:
        case ast.BinOp(left, _, right):
            return [left, right]
        case ast.UnaryOp(_, operand):
            return [operand]
        case ast.Call(_, arguments):
            return arguments
    return []


def check_size(tree: ast.expr, text: Callable[[], str], inserted: Sequence[ast.expr] = ()) -> None:
    """Raise a FormulaError if a formula, with trees that will be inserted, has too many parts or is nested too deeply."""
    levels = [len(level) for level in _levels(tree)]
    size = sum(levels) + sum(map(parts, inserted))
    if size > MOST_PARTS:
        raise FormulaError(
            f"found {size} numbers, names and operations in '{quoted(text())}', expected at most {MOST_PARTS}"
        )
    if len(levels) - 1 > DEEPEST:
        raise FormulaError(
            f"found a formula nested deeper than {DEEPEST} in '{quoted(text())}', expected a flatter one"
        )


def balanced(tree: ast.expr) -> ast.expr:
    """Return the formula with its sums and products as balanced trees if it is too deep."""
    return _halved(tree) if depth(tree) > DEEPEST else tree


def _halved(node: ast.expr) -> ast.expr:
    match node:
        case ast.BinOp(_, op, _) if type(op) in CHAINS:
            return _tree(_chain(node), *CHAINS[type(op)])
        case ast.BinOp(left, op, right):
            return ast.BinOp(_halved(left), op, _halved(right))
        case ast.UnaryOp(op, operand):
            return ast.UnaryOp(op, _halved(operand))
        case ast.Call(name, arguments, keywords):
            return ast.Call(name, list(map(_halved, arguments)), keywords)
    return node


def _chain(node: ast.expr) -> list[tuple[bool, ast.expr]]:
    """Return the terms of a sum or factors of a product, in order; True marks subtracted terms and divisors."""
    assert isinstance(node, ast.BinOp)
    direct, inverse = CHAINS[type(node.op)]
    found: list[tuple[bool, ast.expr]] = []
    while isinstance(node, ast.BinOp) and type(node.op) in (direct, inverse):
        found.append((isinstance(node.op, inverse), _halved(node.right)))
        node = node.left
    return [(False, _halved(node)), *reversed(found)]


def _tree(terms: list[tuple[bool, ast.expr]], direct: type[ast.operator], inverse: type[ast.operator]) -> ast.expr:
    """Return a balanced tree of terms; the first is not inverted."""
    if len(terms) == 1:
        return terms[0][1]
    first, second = terms[: len(terms) // 2], terms[len(terms) // 2 :]
    turned = second[0][0]
    rest = _tree([(other != turned, term) for other, term in second], direct, inverse)
    return ast.BinOp(_tree(first, direct, inverse), inverse() if turned else direct(), rest)
