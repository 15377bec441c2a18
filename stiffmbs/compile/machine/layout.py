"""Tables shared by Python and compiled code, with one named column for each array, number or cell.

A layout lists names and types once; `packed` makes the table in Python, and native code reads it through a view with
the same names (`stiffmbs.compile.machine.native.access`). A column holds the address of an array, a constant number, or
a cell: a number that both sides read and write.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import cached_property
from hashlib import blake2b
from typing import Any, Final, Protocol
from weakref import WeakValueDictionary, finalize

import numpy as np

_HELD: WeakValueDictionary[tuple[str, tuple[int, ...], bytes], np.ndarray] = WeakValueDictionary()
"""Arrays shared by jobs of equal structure, by content."""


class Layout(dict[str, str]):
    """Columns of a table, each with its kind.

    `cells`: view of a table with its cells by name: ``table.view(layout.cells)[0]["steps"]`` is read and written in
    place.
    """

    @cached_property
    def cells(self) -> np.dtype[np.void]:
        """Data type of a table row with its cells by name."""
        columns = {name: column for column, name in enumerate(self) if self[name] in CELLS}
        formats = ["f8" if self[name] == FLOAT_CELL else "i8" for name in columns]
        offsets = [8 * column for column in columns.values()]
        return np.dtype({"names": list(columns), "formats": formats, "offsets": offsets, "itemsize": 8 * len(self)})

    @cached_property
    def columns(self) -> dict[str, int]:
        """Numbers of the columns by name."""
        return {name: column for column, name in enumerate(self)}

    @cached_property
    def given(self) -> tuple[np.ndarray, tuple[str, ...], tuple[np.dtype[Any] | None, ...]]:
        """Columns set by Python (numbers and array addresses): positions, names, and array types."""
        found = {name: column for column, name in enumerate(self) if self[name] in (INT, *DTYPES)}
        types = (np.dtype(DTYPES[self[name]]) if self[name] in DTYPES else None for name in found)
        return np.array([*found.values()], dtype=np.intp), tuple(found), tuple(types)


QUAD: Final = 4
"""Doubles of a SIMD vector."""
CACHE_LINE: Final = 64
"""Size of a processor's cache line, bytes."""
INTS, INDICES, FLOATS, INT = "ints", "indices", "floats", "int"
FLOAT_CELL, INT_CELL = "float cell", "int cell"
CELLS = {FLOAT_CELL: "float", INT_CELL: "int"}
"""Kinds of cells in compiled code."""
DTYPES = {INTS: np.int64, INDICES: np.int32, FLOATS: np.float64}
"""Data types of arrays; indices are 32-bit to save memory bandwidth in long lists."""
OWN = OWN_INTS, OWN_FLOATS = "own ints", "own floats"
POINTERS = {INTS: INTS, INDICES: INDICES, FLOATS: FLOATS, OWN_INTS: INTS, OWN_FLOATS: FLOATS}
"""Kinds of arrays in compiled code, which allocates its own (`stiffmbs.compile.machine.native.memory`)."""


class Addressed(Protocol):
    """Compiled function, by its address."""

    @property
    def address(self) -> int:
        """Address for calls from compiled code."""


class Table(np.ndarray):
    """Words of a table, with the objects whose addresses some of them are (`stiffmbs.compile.machine.image`).

    - `layout`: layout of one row; tables of several rows repeat it.
    - `links`: array, table or compiled function by the index of the word with its address.
    """

    layout: Layout
    links: dict[int, np.ndarray | Addressed]

    def __new__(cls, layout: Layout, rows: int = 1) -> Table:
        """Return a table of zeros."""
        table = np.zeros(rows * len(layout), dtype=np.int64).view(cls)
        table.layout, table.links = layout, {}
        return table

    def link(self, name: str, target: np.ndarray | Addressed, row: int = 0) -> None:
        """Store the address of an array, a table or a compiled function in a column."""
        at = row * len(self.layout) + self.layout.columns[name]
        self[at] = address(target) if isinstance(target, np.ndarray) else target.address
        self.links[at] = target

    def put_row(self, row: int, values: Mapping[str, Any]) -> None:
        """Store numbers, and the addresses of arrays and functions, in a row."""
        for name, value in values.items():
            if isinstance(value, np.ndarray) or hasattr(value, "address"):
                self.link(name, value, row)
            else:
                self[row * len(self.layout) + self.layout.columns[name]] = value

    def rows(self, which: np.ndarray) -> Table:
        """Return a table of some rows, by number."""
        width, found = len(self.layout), Table(self.layout, len(which))
        found.reshape(-1, width)[:] = self.reshape(-1, width)[which]
        for k, row in enumerate(which.tolist()):
            own = range(row * width, (row + 1) * width)
            found.links |= {k * width + at - own.start: self.links[at] for at in own if at in self.links}
        return found

    def same(self) -> Table:
        """Return another table of the same words and links."""
        found = Table(self.layout, len(self) // len(self.layout))
        found[:], found.links = self, dict(self.links)
        return found


def at_a_line(count: int) -> np.ndarray:
    """Return zeros aligned to a cache line: access to quads across two lines is far slower."""
    longer = np.zeros(count + CACHE_LINE // 8)
    first = -longer.ctypes.data % CACHE_LINE // 8
    return longer[first : first + count]


def whole_lines(parts: list[np.ndarray]) -> list[np.ndarray]:
    """Return arrays with zeros up to a whole number of cache lines."""
    return [*parts, np.zeros(-sum(map(len, parts)) % (CACHE_LINE // 8))]


def packed(layout: Layout, values: Mapping[str, object]) -> Table:
    """Return the table for a layout: addresses of arrays, numbers, and cells, zero if no value is given.

    The arrays must be contiguous, of the layout's type, and live as long as the table is used. Arrays owned by compiled
    code are empty at first (`packed_with_memory`).
    """
    table = Table(layout)
    fill(table, values)
    return table


RELEASE = ctypes.pythonapi.PyMem_RawFree
"""Frees the memory of `stiffmbs.compile.machine.native.memory`."""


def packed_with_memory(layout: Layout, values: Mapping[str, object]) -> Table:
    """Return a table as `packed`; compiled code's own arrays are freed with it.

    Users of the table's address must keep the returned array.
    """
    words = packed(layout, values)
    own = [column for column, kind in enumerate(layout.values()) if kind in OWN]
    table = words.view()
    table.layout, table.links = words.layout, words.links
    finalize(table, _free, words, own).atexit = False
    return table


def _free(words: np.ndarray, columns: list[int]) -> None:
    for column in columns:
        RELEASE(ctypes.c_void_p(int(words[column])))
        words[column] = 0


def arrays_of(layout: Layout, lists: Mapping[str, object]) -> dict[str, np.ndarray]:
    """Return lists of numbers, or of rows of numbers, as flat arrays of the layout's types."""
    return {name: np.asarray(values, dtype=DTYPES[layout[name]]).reshape(-1) for name, values in lists.items()}


def fill(table: Table, values: Mapping[str, Any]) -> None:
    """Fill a table; cells without a given value are unchanged. A number may be a compiled function, by its address."""
    layout = table.layout
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
            table.links[layout.columns[name]] = value
            value = address(value)
        elif hasattr(value, "address"):
            table.links[layout.columns[name]] = value
            value = value.address
        numbers.append(int(value))
    table[columns] = numbers


def address(array: np.ndarray) -> int:
    """Return the address of an array's data, faster than ``array.ctypes.data``."""
    if array.size and array.flags.writeable:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]
    at: int = array.__array_interface__["data"][0]
    return at


def addresses(*arrays: np.ndarray) -> list[int]:
    """Return the addresses of several arrays' data."""
    return [address(array) for array in arrays]


def held_once(array: np.ndarray) -> np.ndarray:
    """Return a read-only array of the same content, shared by all users of equal content.

    `array`: constant numbers; compiled code may read them.
    """
    content = np.array(array, order="C")
    content.flags.writeable = False
    key = content.dtype.str, content.shape, blake2b(content.tobytes()).digest()
    return _HELD.setdefault(key, content)
