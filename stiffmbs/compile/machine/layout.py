"""What Python and compiled code share: a table with one named column for each array, number or cell.

A layout lists names and types once; `packed` makes the table on the Python side, and native code reads it through
a view with the same names (`stiffmbs.compile.machine.native.access`).  A column holds the address of an array, a number
that stays, or a cell: a number that both sides read and set.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import cached_property
from hashlib import blake2b
from typing import Any
from weakref import WeakValueDictionary

import numpy as np

_HELD: WeakValueDictionary[tuple[str, tuple[int, ...], bytes], np.ndarray] = WeakValueDictionary()
"""Lists that jobs of equal structure share, by their content."""


class Layout(dict[str, str]):
    """The columns of a table, each with its kind.

    Attributes
    ----------
    cells : dtype
        A table seen by it has its cells by name: ``table.view(layout.cells)[0]["steps"]`` is read and set in the table.
    """

    @cached_property
    def cells(self) -> np.dtype[np.void]:
        """The type of a row of a table by this layout, with its cells by name."""
        columns = {name: column for column, name in enumerate(self) if self[name] in CELLS}
        formats = ["f8" if self[name] == FLOAT_CELL else "i8" for name in columns]
        offsets = [8 * column for column in columns.values()]
        return np.dtype({"names": list(columns), "formats": formats, "offsets": offsets, "itemsize": 8 * len(self)})

    @cached_property
    def given(self) -> tuple[np.ndarray, tuple[str, ...], tuple[np.dtype[Any] | None, ...]]:
        """The columns whose values Python gives, numbers and addresses of arrays: their places, names, and types of the arrays."""
        found = {name: column for column, name in enumerate(self) if self[name] in (INT, *DTYPES)}
        types = (np.dtype(DTYPES[self[name]]) if self[name] in DTYPES else None for name in found)
        return np.array([*found.values()], dtype=np.intp), tuple(found), tuple(types)


INTS, INDICES, FLOATS, INT = "ints", "indices", "floats", "int"
FLOAT_CELL, INT_CELL = "float cell", "int cell"
CELLS = {FLOAT_CELL: "float", INT_CELL: "int"}
"""Kinds of cells in compiled code."""
DTYPES = {INTS: np.int64, INDICES: np.int32, FLOATS: np.float64}
"""Of the arrays; indices are short where long lists of them are read anew with each evaluation."""
OWN = OWN_INTS, OWN_INDICES, OWN_FLOATS = "own ints", "own indices", "own floats"
POINTERS = {INTS: INTS, INDICES: INDICES, FLOATS: FLOATS, OWN_INTS: INTS, OWN_INDICES: INDICES, OWN_FLOATS: FLOATS}
"""Kinds of arrays in compiled code.  Compiled code itself asks for the memory of those of its own, as their size is known
only on the way (`stiffmbs.compile.machine.native.memory`)."""


def packed(layout: Layout, values: Mapping[str, Any]) -> np.ndarray:
    """The table for a layout: addresses of arrays, numbers as they are, and cells, zero where no value is given.

    The arrays must be contiguous, of the layout's type, and live as long as the table is used.  Arrays of compiled
    code's own are empty at first (`stiffmbs.compile.machine.own_memory`).
    """
    table = np.zeros(len(layout), dtype=np.int64)
    fill(table, layout, values)
    return table


def arrays_of(layout: Layout, lists: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Lists of numbers, or of rows of them, as flat arrays of the layout's types."""
    return {name: np.asarray(values, dtype=DTYPES[layout[name]]).reshape(-1) for name, values in lists.items()}


def fill(table: np.ndarray, layout: Layout, values: Mapping[str, Any]) -> None:
    """Fill a table; cells for which no value is given keep theirs."""
    own = table.view(layout.cells)[0]
    for name in layout.cells.names or ():
        if name in values:
            own[name] = values[name]
    columns, names, types = layout.given
    numbers = []
    for name, dtype in zip(names, types, strict=True):
        value = values[name]
        if dtype is not None:
            assert isinstance(value, np.ndarray) and value.flags.c_contiguous, name
            assert value.dtype == dtype, name
            value = address(value)
        numbers.append(int(value))
    table[columns] = numbers


def address(array: np.ndarray) -> int:
    """The address of an array's numbers, in a tenth of the time that ``array.ctypes.data`` takes."""
    if array.size and array.flags.writeable:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]
    at: int = array.__array_interface__["data"][0]
    return at


def addresses(*arrays: np.ndarray) -> list[int]:
    """The addresses of several arrays' numbers."""
    return [address(array) for array in arrays]


def held_once(array: np.ndarray) -> np.ndarray:
    """An array of the same content that nobody can write, which all who ask for it share for as long as any of them uses it.

    Parameters
    ----------
    array : ndarray
        Of numbers that stay as they are; compiled code may read them.
    """
    content = np.array(array, order="C")
    content.flags.writeable = False
    key = content.dtype.str, content.shape, blake2b(content.tobytes()).digest()
    return _HELD.setdefault(key, content)
