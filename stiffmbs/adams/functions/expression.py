"""Parser of Adams/Solver function expressions.

The grammar is Fortran arithmetic (``**``, exponents with E or D, names in any case), degrees as ``90D``, and ``IF(a: b,
c, d)``. Fortran's operators have the precedence of Python's, so the tokens are rewritten and parsed by `ast`.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator
from typing import Final

from ...reading.files.quoted import quoted
from ...reading.formula.text import BINARY, UNARY
from .trees import number

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[ED][+-]?\d+)?)(?P<degrees>D(?![\w.]))?(?![A-Za-z_])"
    r"|(?P<name>[A-Z_]\w*)|(?P<sign>\*\*|[-+*/(),:^]))",
    re.IGNORECASE,
)
OMITTED = "OMITTED_"
"""Placeholder name of an omitted argument: ``DX(21,,3)``."""
IF = "IF_"
"""Name of IF in a tree; ``if`` is a Python keyword."""


LARGEST_WHOLE: Final = 2**53
"""Integers from this size on are written in floating point."""


class ExpressionError(ValueError):
    """Invalid expression; the message states what was found and what was expected."""


def parse(text: str) -> ast.expr:
    """Parse an expression of numbers, names, calls and the operators ``+ - * / **``; names become upper case.

    Raises ExpressionError if the text is not an expression.
    """
    spelt = " ".join(_python_tokens(text))
    try:
        tree = ast.parse(spelt, mode="eval").body
        _check(tree, text)
        return _WithoutPowersOfNumbers(text).visit(tree)
    except ExpressionError:
        raise
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f"found '{quoted(text)}', expected a function expression") from None


def _python_tokens(text: str) -> Iterator[str]:
    """Yield the tokens of an expression in Python's spelling."""
    at, rest, before = 0, text.rstrip(), ""
    while at < len(rest):
        token = _TOKEN.match(rest, at)
        if token is None:
            raise ExpressionError(
                f"found '{rest[at:].strip()[:20]}' in '{quoted(text)}', expected a function expression"
            )
        at = token.end()
        if token["sign"] == "," and before in ("(", ","):
            yield OMITTED
        before = token["sign"] or ""
        if token["number"]:
            yield _number(token)
        elif token["name"]:
            word = token["name"].upper()
            yield IF if word == "IF" else word
        else:
            yield {":": ",", "^": "**"}.get(token["sign"], token["sign"])


def _number(token: re.Match[str]) -> str:
    value = float(token["number"].upper().replace("D", "E"))
    if math.isinf(value):
        raise ExpressionError(f"found the number {quoted(token['number'])}, expected one below 1e308")
    if token["degrees"]:
        value = math.radians(value)
    whole = re.fullmatch(r"\d+", token["number"]) and not token["degrees"]
    return str(int(token["number"])) if whole and value < LARGEST_WHOLE else repr(value)


class _WithoutPowersOfNumbers(ast.NodeTransformer):
    """Replace powers of numbers by their floating-point values; Python's integer powers have unbounded size."""

    def __init__(self, text: str) -> None:
        self._text = text

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """Evaluate a power of numbers in floating point."""
        self.generic_visit(node)
        if not isinstance(node.op, ast.Pow):
            return node
        base, exponent = constant(node.left), constant(node.right)
        if base is None or exponent is None:
            return node
        try:
            value = base**exponent
        except ArithmeticError:
            value = math.inf
        if isinstance(value, complex) or not math.isfinite(value):
            raise ExpressionError(
                f"found '{ast.unparse(node)}' in '{quoted(self._text)}', which has no finite real value"
            )
        return number(value)


def constant(node: ast.expr) -> float | None:
    """Return the floating-point value of a number or arithmetic of numbers; None for anything else or if undefined."""
    match node:
        case ast.Constant(int() | float() as value):
            return float(value)
        case ast.UnaryOp(op, operand):
            inner = constant(operand)
            return None if inner is None else UNARY[type(op)](inner)
        case ast.BinOp(left, op, right) if not isinstance(op, ast.Pow):
            a, b = constant(left), constant(right)
            try:
                return None if a is None or b is None else BINARY[type(op)](a, b)
            except ArithmeticError:
                return None
    return None


def _check(node: ast.expr, text: str) -> None:
    match node:
        case ast.BinOp(left, ast.Add() | ast.Sub() | ast.Mult() | ast.Div() | ast.Pow(), right):
            children = [left, right]
        case ast.UnaryOp(ast.UAdd() | ast.USub(), operand):
            children = [operand]
        case ast.Call(ast.Name(), arguments, []):
            children = arguments
        case ast.Constant(int() | float()) | ast.Name():
            children = []
        case _:
            raise ExpressionError(f"found '{quoted(text)}', expected a function expression")
    for child in children:
        _check(child, text)
