"""Text of Adams/Solver statements: one argument per line, long functions broken between operands."""

from __future__ import annotations

import re
from collections.abc import Iterable

WIDTH = 76
"""Characters per line; Adams/Solver reads 80."""
_CUT = re.compile(r"(?<=[,*/+)])(?<!\dE\+)(?!\*)")
"""Positions of line breaks, neither within ** nor within an exponent."""


class Refusal(Exception):
    """Element or field without an equivalent in Adams/Solver; the message states both and the alternatives."""


def number(value: float) -> str:
    """Return a number with all its digits and the exponent sign E of Adams."""
    value = float(value)
    text = str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return text.replace("e", "E")


def numbers(values: Iterable[float]) -> str:
    """Return a comma-separated list of numbers."""
    return ", ".join(map(number, values))


def statement(keyword: str, ident: int | None, *arguments: str) -> str:
    """Return a statement: its first line, and a continuation line for each argument."""
    head = f"{keyword}/" if ident is None else f"{keyword}/{ident}"
    return "\n".join([head, *(line for argument in arguments for line in _lines(argument))])


def _lines(argument: str) -> list[str]:
    """Return an argument as continuation lines."""
    found = [", "]
    for piece in _CUT.split(argument):
        if len(found[-1]) + len(piece) > WIDTH and found[-1].strip(" ,"):
            found.append(", ")
        found[-1] += piece
    return found
