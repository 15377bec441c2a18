"""Statements as text: an argument to a line, long functions cut between their signs."""

from __future__ import annotations

import re
from collections.abc import Iterable

WIDTH = 76
"""Signs to a line; Adams/Solver reads 80."""
_CUT = re.compile(r"(?<=[,*/+)])(?<!\dE\+)(?!\*)")
"""Neither within ** nor within an exponent."""


def number(value: float) -> str:
    """A number with all its digits, as Adams writes exponents."""
    value = float(value)
    text = str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return text.replace("e", "E")


def numbers(values: Iterable[float]) -> str:
    """A list of numbers."""
    return ", ".join(map(number, values))


def statement(keyword: str, ident: int | None, *arguments: str) -> str:
    """A statement: its first line, and a continuation line for each argument."""
    head = f"{keyword}/" if ident is None else f"{keyword}/{ident}"
    return "\n".join([head, *(line for argument in arguments for line in _lines(argument))])


def _lines(argument: str) -> list[str]:
    """An argument on continuation lines; the comma that begins a line parts nothing within a function."""
    found = [", "]
    for piece in _CUT.split(argument):
        if len(found[-1]) + len(piece) > WIDTH and found[-1].strip(" ,"):
            found.append(", ")
        found[-1] += piece
    return found
