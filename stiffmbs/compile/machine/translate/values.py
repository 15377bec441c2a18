"""Values of the language during translation."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass, replace
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
    "dual": "{ double, double }",
    "duals": "{ ptr, ptr }",
    "dual quad": "{ <4 x double>, <4 x double> }",
}
"""LLVM types of the kinds: numbers, truth values, C int, pointers to int64, int32 and float64, SIMD vectors, dual numbers.

A dual number is a number with its derivative in a direction; a pointer to dual numbers is one to numbers and one to derivatives.
"""
DUAL_KINDS = {"float": "dual", "floats": "duals", "quad": "dual quad"}
"""Kinds of dual values by the kind of both parts."""
ITEMS = {"ints": "int", "indices": "int32", "floats": "float", "duals": "dual"}
"""Item kinds of pointers."""
NUMBERS = ("float", "int", "int32")
"""Kinds of numbers in memory, for type-based alias analysis."""
POINTERS_TO = {item: pointer for pointer, item in ITEMS.items()}


class Untranslatable(TypeError):
    """Construct outside the language; the message contains the line."""


class Wider(Exception):
    """A variable needs memory of a wider kind; the function must be translated again."""

    def __init__(self, name: str, kind: str) -> None:
        super().__init__(name, kind)
        self.name, self.kind = name, kind


@dataclass(frozen=True)
class Value:
    """Value of a kind in `LLVM_TYPES`, with its name or literal in LLVM assembly."""

    kind: str
    text: str

    @property
    def typed(self) -> str:
        """Operand with its type."""
        return f"{LLVM_TYPES[self.kind]} {self.text}"


@dataclass(frozen=True)
class Cell(Value):
    """Named number in memory: kind and address."""

    @property
    def typed(self) -> str:
        """Address as an operand: functions called with a cell may set it."""
        return f"ptr {self.text}"


@dataclass(frozen=True)
class Dual(Value):
    """Value with its derivative in a direction."""

    value: Value
    slope: Value

    @property
    def typed(self) -> str:
        """Both parts as operands."""
        return f"{self.value.typed}, {self.slope.typed}"


def dual(value: Value, slope: Value) -> Dual:
    """Return a value with its derivative."""
    return Dual(DUAL_KINDS[value.kind], "", value, slope)


def renamed(value: Value, text: str) -> Value:
    """Return a value of the same kind with another name."""
    if isinstance(value, Dual):
        return dual(renamed(value.value, text), renamed(value.slope, f"{text}_d"))
    return replace(value, text=text)


@dataclass(frozen=True)
class Record:
    """Named values and cells; exists during translation only."""

    name: str
    fields: dict[str, Value]


@dataclass(frozen=True)
class Passed:
    """Function given to another one, which is translated for it."""

    function: Callable[..., object]


Operand = Value | Record | Passed | tuple[Any, ...]


@dataclass(frozen=True)
class Builtin:
    """Function expanded by the translator: ``lower(code, *arguments)`` returns its value, or None."""

    lower: Callable[..., Any]

    def __call__(self, *arguments: object) -> Any:
        raise TypeError(f"{self.lower.__name__}: exists in compiled code alone")


def builtin(lower: Callable[..., object]) -> Any:
    """Mark a function ``lower(code, *arguments)`` that writes instructions itself."""
    return Builtin(lower)


def undirected(value: Any) -> Value:
    """Return a value without its derivative."""
    return value.value if isinstance(value, Dual) else value


def slope_of(value: Operand) -> Value | None:
    """Return the derivative of a value; None for one without."""
    return value.slope if isinstance(value, Dual) else None


def refuse(node: ast.AST, what: str) -> Untranslatable:
    """Return the error for a construct."""
    return Untranslatable(f"line {getattr(node, 'lineno', '?')}: {what}: {ast.unparse(node)}")
