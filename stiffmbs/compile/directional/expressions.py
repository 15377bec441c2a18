"""Constructors of Python expressions with zeros dropped; None stands for zero."""

from __future__ import annotations

import ast

Part = ast.expr | None


def number(value: float) -> ast.expr:
    """Return a literal."""
    return ast.Constant(value)


def literal(node: ast.expr) -> int:
    """Return the value of an integer literal with or without a sign.

    Raises
    ------
    ValueError
        If the expression is not a literal.
    """
    return int(ast.literal_eval(node))


def whole(part: Part) -> ast.expr:
    """Return the expression, or a literal zero."""
    return number(0.0) if part is None else part


def added(*parts: Part) -> Part:
    """Return a sum."""
    total: Part = None
    for part in parts:
        if part is not None:
            total = part if total is None else ast.BinOp(total, ast.Add(), part)
    return total


def negated(part: Part) -> Part:
    """Return the negative."""
    return None if part is None else ast.UnaryOp(ast.USub(), part)


def difference(a: Part, b: Part) -> Part:
    """Return a - b."""
    if a is None or b is None:
        return negated(b) if a is None else a
    return ast.BinOp(a, ast.Sub(), b)


def multiplied(a: Part, b: Part) -> Part:
    """Return a b."""
    return None if a is None or b is None else ast.BinOp(a, ast.Mult(), b)


def divided(a: Part, b: Part) -> Part:
    """Return a / b; b must not be the zero expression."""
    return None if a is None else ast.BinOp(a, ast.Div(), whole(b))


def squared(a: ast.expr) -> ast.expr:
    """Return a a."""
    return ast.BinOp(a, ast.Mult(), a)


def called(name: str, *arguments: Part) -> ast.expr:
    """Return a function call."""
    return ast.Call(ast.Name(name), [whole(argument) for argument in arguments], [])
