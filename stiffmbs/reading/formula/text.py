"""Arithmetic in scenes: parsing of text to a checked syntax tree, and its evaluation.

A formula cannot run code. The tree is made by ``ast.parse``, every node is checked against a closed list, and names are
looked up in tables of the caller. A number followed by a unit binds tightly (``10 N/5 mm`` is 2 N/mm), and a power
belongs to the unit (``2 mm^2``). A name that follows a value without an operator is looked up as ``unit.name``, so a
scene can have a parameter N and the unit newton.
"""

from __future__ import annotations

import ast
import io
import operator
import re
import sys
import tokenize
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from ..files.quoted import quoted
from .size import MOST_PARTS, FormulaError, balanced, check_size, within

UNIT = "unit"
_NUMBER_AND_NAME = re.compile(r"(?<![\w.])((?>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))(?=[A-Za-z_])")
"""Number directly followed by a name, as in ``20deg``, which tokenizers since Python 3.12 refuse."""
LONGEST_TEXT = 50 * MOST_PARTS
"""Largest number of characters of a formula, which bounds the time to count its parts."""
TEXTS = 4096
"""Number of cached texts."""

UNIT_BY_KEYWORD = {"in": "inch"}
"""Units whose names are keywords of Python."""

BINARY: dict[type[ast.operator], Callable[[object, object], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {ast.UAdd: operator.pos, ast.USub: operator.neg}


def parse(text: str) -> ast.expr:
    """Read a formula such as ``"20 deg"`` or ``"cart.y - 0.1*sin(cart.x)"`` into a checked syntax tree.

    Raises FormulaError if the text is not a formula, or has other parts than arithmetic, names, ``name.name`` and calls
    by name.
    """
    if len(text) > LONGEST_TEXT:
        raise FormulaError(f"found a formula of {len(text)} characters, expected at most {LONGEST_TEXT}")
    try:
        tree = balanced(ast.parse(_python_spelling(text), mode="eval").body)
        check_size(tree, lambda: text)
    except FormulaError:
        raise
    except (SyntaxError, tokenize.TokenError, ValueError, RecursionError, MemoryError):
        raise FormulaError(
            f"found '{quoted(text)}', expected a number or a formula such as '125 mm' or '0.6/2'"
        ) from None
    _check(tree, text)
    return _with_owners(tree)


def _first_owner(node: ast.expr) -> ast.expr:
    while isinstance(node, ast.Attribute):
        node = node.value
    return node


def _with_owners(tree: ast.expr) -> ast.expr:
    """Merge the owner of each ``front.left.arm.x`` into one name with dots, in place."""
    for node in within(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Attribute):
            node.value = ast.Name(ast.unparse(node.value))
    return tree


@lru_cache(maxsize=TEXTS)
def _python_spelling(text: str) -> str:
    """Rewrite ``5 N m/rad`` as ``(5*unit.N*unit.m)/rad`` and ``^`` as ``**``."""
    spaced = _NUMBER_AND_NAME.sub(r"\1 ", text.strip().replace("^", "**"))
    read = tokenize.generate_tokens(io.StringIO(spaced).readline)
    tokens = [token.string for token in read if token.string.strip()]  # a formula may span lines
    words: list[str] = []
    k = 0
    while k < len(tokens):
        if _is_number(tokens[k]) and k + 1 < len(tokens) and tokens[k + 1].isidentifier():
            if words and words[-1].isidentifier():  # a parenthesis would make it a call
                raise SyntaxError
            words += ["(", tokens[k]]
            k += 1
            while k < len(tokens) and tokens[k].isidentifier():
                end = k + _factor_length(tokens, k)
                words += [*_times_unit(tokens[k]), *tokens[k + 1 : end]]
                k = end
            words.append(")")
        elif words and tokens[k].isidentifier() and (words[-1].isidentifier() or words[-1] == ")"):
            words += _times_unit(tokens[k])
            k += 1
        else:
            words.append(tokens[k])
            k += 1
    return " ".join(words)


def _is_number(token: str) -> bool:
    return token[0].isdigit() or (token[0] == "." and token[1:2].isdigit())


def _factor_length(tokens: list[str], at: int) -> int:
    """Return the number of tokens of the unit at `at` with its power: ``mm``, ``mm ** 2``, ``m ** ( 1 / 2 )``.

    Powers are right-associative: ``m ** 2 ** 2`` is ``m ** 4``.
    """
    end = at + 1
    while tokens[end : end + 1] == ["**"]:
        end += 1
        while tokens[end : end + 1] in (["-"], ["+"]):
            end += 1
        end = _closing(tokens, end) if tokens[end : end + 1] == ["("] else end + 1
    return end - at


def _closing(tokens: list[str], at: int) -> int:
    """Return the position after the parenthesis that closes the one at `at`."""
    depth = 0
    for end in range(at, len(tokens)):
        depth += (tokens[end] == "(") - (tokens[end] == ")")
        if not depth:
            return end + 1
    return len(tokens)


def _times_unit(name: str) -> list[str]:
    return ["*", UNIT, ".", UNIT_BY_KEYWORD.get(name, name)]


def _check(node: ast.AST, text: str) -> None:
    match node:
        case ast.BinOp(left, op, right) if type(op) in BINARY:
            children: list[ast.AST] = [left, right]
        case ast.UnaryOp(op, operand) if type(op) in UNARY:
            children = [operand]
        case ast.Constant(bool()):
            raise FormulaError(f"found '{quoted(text)}', expected a number or a formula, not a truth value")
        case ast.Constant(int() | float() as value):
            if not abs(value) <= sys.float_info.max:
                raise FormulaError(f"found a number that is too large in '{quoted(text)}'")
            return
        case ast.Name():
            return
        case ast.Attribute(owner) if isinstance(_first_owner(owner), ast.Name):
            return
        case ast.Call(ast.Name(), list() as arguments, []) if not any(isinstance(a, ast.Starred) for a in arguments):
            children = list(arguments)
        case _:
            raise FormulaError(f"found '{quoted(text)}', expected only arithmetic, names and functions")
    for child in children:
        _check(child, text)


def real_power(base: float, exponent: float) -> float:
    """Return a power of real numbers; raise a FormulaError if it is not real."""
    value = base**exponent
    if isinstance(value, complex):
        raise FormulaError("found a fractional power of a negative number")
    return value


OF_NUMBERS = BINARY | {ast.Pow: real_power}
"""Operators for real numbers."""


def evaluate(
    tree: ast.expr,
    names: Callable[[str], object],
    functions: Mapping[str, Callable[..., object]],
    number: Callable[[int | float], object] = float,
    binary: Mapping[type[ast.operator], Callable[[Any, Any], object]] = BINARY,
) -> Any:
    """Evaluate a checked tree in any algebra (numbers, arrays, SymPy expressions).

    `names`: returns the value of a name such as ``L`` or ``cart.x``; raises `FormulaError` for an unknown one.
    `number`: converts a literal to a value of the algebra. `binary`: operators of the algebra.
    """

    def of(node: ast.expr) -> Any:
        return evaluate(node, names, functions, number, binary)

    match tree:
        case ast.BinOp(left, op, right):
            return binary[type(op)](of(left), of(right))
        case ast.UnaryOp(op, operand):
            return UNARY[type(op)](of(operand))
        case ast.Constant(int() | float() as value):
            return number(value)
        case ast.Name(name):
            return names(name)
        case ast.Attribute(ast.Name(owner), name):
            return names(f"{owner}.{name}")
        case ast.Call(ast.Name(name), arguments):
            if name not in functions:
                raise FormulaError(f"found the function '{name}', expected one of {', '.join(sorted(functions))}")
            try:
                return functions[name](*map(of, arguments))
            except TypeError:
                raise FormulaError(
                    f"found {len(arguments)} arguments of '{name}', expected more or fewer of them"
                ) from None
        case _:
            raise FormulaError("found something that is no arithmetic")


def as_written(node: ast.expr) -> str:
    """Return a part of a formula in the notation of scenes, for messages: ``3 kg`` and ``x^2``."""
    text = re.sub(rf" \* {UNIT}\.", " ", ast.unparse(node))
    return text.replace(f"{UNIT}.", "").replace(" ** ", "^").replace("**", "^")
