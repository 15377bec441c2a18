"""Function expressions of Adams/Solver as syntax trees.

Their grammar is Fortran's arithmetic (``**``, exponents with E or D, names in any case), degrees as ``90D``, and
``IF(a: b, c, d)``.  Fortran's operators bind as Python's do, so that an expression is spelt anew and read by `ast`.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[ED][+-]?\d+)?)(?P<degrees>D(?![\w.]))?(?![A-Za-z_])"
    r"|(?P<name>[A-Z_]\w*)|(?P<sign>\*\*|[-+*/(),:^]))",
    re.IGNORECASE,
)
OMITTED = "OMITTED_"
"""What an argument is called that is left out: ``DX(21,,3)``."""
IF = "IF_"
"""What IF is called in a tree, as Python keeps that word to itself."""


class ExpressionError(ValueError):
    """An expression that cannot be read; the message says what was found and what was expected."""


def parse(text: str) -> ast.expr:
    """The tree of an expression: numbers, names in capitals, calls, and the operators ``+ - * / **``.

    Raises
    ------
    ExpressionError
        When the text is no expression.
    """
    spelt = " ".join(_python_tokens(text))
    try:
        tree = ast.parse(spelt, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f"found '{text}', expected a function expression") from None
    _check(tree, text)
    return tree


def _python_tokens(text: str) -> Iterator[str]:
    """The expression's tokens as Python spells them."""
    at, rest, before = 0, text.rstrip(), ""
    while at < len(rest):
        token = _TOKEN.match(rest, at)
        if token is None:
            raise ExpressionError(f"found '{rest[at:].strip()[:20]}' in '{text}', expected a function expression")
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
    if token["degrees"]:
        value = math.radians(value)
    whole = re.fullmatch(r"\d+", token["number"]) and not token["degrees"]
    return str(int(token["number"])) if whole else repr(value)


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
            raise ExpressionError(f"found '{text}', expected a function expression")
    for child in children:
        _check(child, text)
