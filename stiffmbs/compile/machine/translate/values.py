"""What expressions of the language stand for while they are translated."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

LLVM_TYPES = {
    "int": "i64",
    "float": "double",
    "bool": "i1",
    "int32": "i32",
    "ints": "ptr",
    "indices": "ptr",
    "floats": "ptr",
    "quad": "<4 x double>",
    "octet": "<8 x double>",
}
"""The kinds of values: numbers, truth values, C's int, pointers to int64, int32 and float64, four floats side by side."""
ITEMS = {"ints": "int", "indices": "int32", "floats": "float"}
"""What a pointer points to."""
NUMBERS = ("float", "int", "int32")
"""Kinds of numbers in memory: what is written as one of them is never read as another."""
POINTERS_TO = {item: pointer for pointer, item in ITEMS.items()}


class Untranslatable(TypeError):
    """A construct that is not of the language; the message says where."""


class Wider(Exception):
    """A variable needs memory of a kind that holds all its values: the function must be translated anew with it."""

    def __init__(self, name: str, kind: str) -> None:
        super().__init__(name, kind)
        self.name, self.kind = name, kind


@dataclass(frozen=True)
class Value:
    """A value of one of the kinds in `LLVM_TYPES`, and its name or number in LLVM's assembly."""

    kind: str
    text: str

    @property
    def typed(self) -> str:
        """As an operand with its type."""
        return f"{LLVM_TYPES[self.kind]} {self.text}"


@dataclass(frozen=True)
class Cell(Value):
    """A number in memory under a name: its kind, and its address."""

    @property
    def typed(self) -> str:
        """Its address as an operand: functions that are given a cell may set it."""
        return f"ptr {self.text}"


@dataclass(frozen=True)
class Record:
    """Named values and cells that are known one by one; exists only while translating."""

    name: str
    fields: dict[str, Value]


Operand = Value | Record | tuple[Any, ...]


@dataclass(frozen=True)
class Builtin:
    """A function that the translator writes out itself: ``lower(code, *arguments)`` gives its value, or None."""

    lower: Callable[..., Any]

    def __call__(self, *arguments: Any) -> Any:
        raise TypeError(f"{self.lower.__name__}: exists in compiled code alone")


def builtin(lower: Callable[..., Any]) -> Any:
    """Mark a function ``lower(code, *arguments)`` as one that writes instructions itself."""
    return Builtin(lower)


def refuse(node: ast.AST, what: str) -> Untranslatable:
    """The error for a construct."""
    return Untranslatable(f"line {getattr(node, 'lineno', '?')}: {what}: {ast.unparse(node)}")
