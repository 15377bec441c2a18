"""How large a formula may be: the number of its parts, and how many are within each other."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterator, Sequence

from ..files.quoted import quoted

MOST_PARTS = 2000
"""Numbers, names and operations in a formula, with the variables in it."""
DEEPEST = 60
"""Operations and functions within each other, after long sums and products have been balanced."""
CHAINS: dict[type[ast.operator], tuple[type[ast.operator], type[ast.operator]]] = {
    ast.Add: (ast.Add, ast.Sub), ast.Sub: (ast.Add, ast.Sub), ast.Mult: (ast.Mult, ast.Div), ast.Div: (ast.Mult, ast.Div),
}  # fmt: skip
"""Operators that stand in one chain, and the two that it consists of."""


class FormulaError(ValueError):
    """A formula that cannot be read or evaluated; the message is the rest of a sentence that starts with where."""


def parts(tree: ast.expr) -> int:
    """How many numbers, names and operations a formula has."""
    return sum(map(len, _levels(tree)))


def depth(tree: ast.expr) -> int:
    """How many parts of a formula are within each other."""
    return sum(1 for _ in _levels(tree)) - 1


def within(tree: ast.expr) -> Iterator[ast.expr]:
    """The parts of a formula, the outer ones before those within them."""
    return itertools.chain.from_iterable(_levels(tree))


def _levels(tree: ast.expr) -> Iterator[list[ast.expr]]:
    """The parts of a formula, from the outermost inwards."""
    level = [tree]
    while level:
        yield level
        level = [child for node in level for child in _children(node)]


def _children(node: ast.expr) -> list[ast.expr]:
    match node:
        case ast.BinOp(left, _, right):
            return [left, right]
        case ast.UnaryOp(_, operand):
            return [operand]
        case ast.Call(_, arguments):
            return arguments
    return []


def check_size(tree: ast.expr, text: Callable[[], str], inserted: Sequence[ast.expr] = ()) -> None:
    """Refuse a formula of too many parts, or with too many within each other.

    Parameters
    ----------
    tree : ast.expr
    text : callable
        What messages call it, made when there is one.
    inserted : sequence of ast.expr
        What is to be put into it.

    Raises
    ------
    FormulaError
    """
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
    """A formula that is too deep with its sums and products halved again and again, so that many terms are not deep."""
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
    """The terms of a sum, or the factors of a product, in order, and whether each is taken away, or divided by."""
    assert isinstance(node, ast.BinOp)
    direct, inverse = CHAINS[type(node.op)]
    found: list[tuple[bool, ast.expr]] = []
    while isinstance(node, ast.BinOp) and type(node.op) in (direct, inverse):
        found.append((isinstance(node.op, inverse), _halved(node.right)))
        node = node.left
    return [(False, _halved(node)), *reversed(found)]


def _tree(terms: list[tuple[bool, ast.expr]], direct: type[ast.operator], inverse: type[ast.operator]) -> ast.expr:
    """Terms, the first of which is not inverted, as a tree of little depth."""
    if len(terms) == 1:
        return terms[0][1]
    first, second = terms[: len(terms) // 2], terms[len(terms) // 2 :]
    turned = second[0][0]
    rest = _tree([(other != turned, term) for other, term in second], direct, inverse)
    return ast.BinOp(_tree(first, direct, inverse), inverse() if turned else direct(), rest)
