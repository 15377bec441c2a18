"""Pointers from addresses, kernel calls by address, and named views of pointer tables.

Functions of compiled code in Python, for debugging: docs/project/compiled_code.md.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..layout import CELLS, INT, POINTERS, Layout
from ..translate.code import Code, constant
from ..translate.values import Builtin, Cell, Dual, Operand, Record, Untranslatable, Value, builtin, dual
from .tables import EQUATIONS, FACTORS, STATE


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a function for compiled routines, written in the language of `stiffmbs.compile.machine.translate`."""
    return function


def _pointer(code: Code, kind: str, address: Operand) -> Value:
    return code.put_value(kind, f"inttoptr {code.integer(address).typed} to ptr")


@builtin
def floats(code: Code, address: Operand) -> Value:
    """Return a pointer to the doubles at an address."""
    return _pointer(code, "floats", address)


@builtin
def ints(code: Code, address: Operand) -> Value:
    """Return a pointer to the 64-bit integers at an address."""
    return _pointer(code, "ints", address)


@builtin
def shifted(code: Code, pointer: Value, count: Operand) -> Value:
    """Return the pointer `count` items further on."""
    if isinstance(pointer, Dual):
        return dual(shifted.lower(code, pointer.value, count), shifted.lower(code, pointer.slope, count))
    return Value(pointer.kind, code.item(pointer, count).text)


@builtin
def with_derivative(code: Code, value: Value, slope: Value) -> Value:
    """Return a number or pointer with its derivative; functions called with it are differentiated in forward mode."""
    return dual(value, slope)


@builtin
def has_derivative(code: Code, value: Value) -> Value:
    """Return True in a function that is differentiated by this number or pointer."""
    return constant(isinstance(value, Dual))


@builtin
def room(code: Code, count: Operand) -> Value:
    """Return memory for the given count of numbers, for the duration of the function."""
    return code.array(int(code.integer(count).text))


@builtin
def call_kernel(code: Code, kernel: Operand, *arguments: Value) -> None:
    """Call a kernel (`stiffmbs.compile.terms.KERNEL_SIGNATURE`) by its address."""
    code.put(f"call void {ints.lower(code, kernel).text}({', '.join(argument.typed for argument in arguments)})")


@builtin
def address_of(code: Code, cell: Value) -> Value:
    """Return the address of a cell, ``address_of(record.cell)``, for C functions; expanded by the translator."""
    raise Untranslatable(f"found {cell}, expected a cell of a record")


def view_of(name: str, layout: Layout) -> Builtin:
    """Return a function of compiled code that views a table as a record of pointers, numbers and cells."""

    def view(code: Code, table: Value) -> Record:
        """Load the pointers and numbers of a table; its cells are not loaded."""
        fields: dict[str, Value] = {}
        for column, (field, kind) in enumerate(layout.items()):
            place = code.item(table, constant(column))
            if kind in CELLS:
                fields[field] = Cell(CELLS[kind], place.text)
                continue
            entry = code.load(place)
            fields[field] = entry if kind == INT else _pointer(code, POINTERS[kind], entry)
        return Record(name, fields)

    return Builtin(view)


def parts_of(name: str, lengths: Mapping[str, int]) -> Builtin:
    """Return a function of compiled code that views memory as a record of consecutive vectors of these lengths."""

    def view(code: Code, memory: Value) -> Record:
        """Return the vectors by name."""
        fields, first = {}, 0
        for field, length in lengths.items():
            fields[field] = shifted.lower(code, memory, constant(first))
            first += length
        return Record(name, fields)

    return Builtin(view)


def row_of(kind: type[tuple[int, ...]]) -> Builtin:
    """Return a function of compiled code, ``row(rows, number)``, that views a row of integers as a record.

    `kind`: `typing.NamedTuple` of integers: the columns of a list whose rows are stored one after the other.
    """
    columns: tuple[str, ...] = kind._fields  # type: ignore[attr-defined]

    def row(code: Code, rows: Value, number: Operand) -> Record:
        """Load the integers of a row."""
        start = code.put_value("int", f"mul nsw {code.integer(number).typed}, {len(columns)}")
        first = shifted.lower(code, rows, start)
        items = (code.load(code.item(first, constant(column))) for column in range(len(columns)))
        return Record(kind.__name__, dict(zip(columns, map(code.integer, items), strict=True)))

    return Builtin(row)


state_view = view_of("State", STATE)
equations_view = view_of("Equations", EQUATIONS)
factors_view = view_of("Factors", FACTORS)
