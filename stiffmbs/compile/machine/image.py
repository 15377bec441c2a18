"""Tables and arrays of a model in one relocatable block of memory.

Compiled code takes all data from tables (`stiffmbs.compile.machine.layout`), which know the objects whose addresses they
contain. An image is a copy of some tables and of everything that they reach. Its addresses are two lists of
relocations, so that a program needs three steps for a new instance: allocate, copy, relocate.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .layout import CACHE_LINE, OWN, Addressed, Layout, Table, address

WORD = np.dtype(np.int64).itemsize
"""Bytes of a word of a table."""
EMPTIED = ("capacity", "ready")
"""Cells that are zero in tables whose own arrays are not allocated."""


@dataclass(frozen=True)
class Image:
    """Copy of tables and arrays, with offsets in place of addresses.

    - `content`: bytes up to the last that is not zero, a whole number of words. `size`: bytes of the whole block, aligned to `CACHE_LINE`.
    - `links`: offset of each address of data, and the offset that it points to, shape (n, 2).
    - `calls`: offset of each address of a function, and its place in `functions`, shape (n, 2).
    - `own`: offsets of the words that describe arrays which compiled code allocates, first the addresses, shape (n,);
      `n_owned` of them are addresses.
    """

    content: bytes
    size: int
    links: np.ndarray
    calls: np.ndarray
    functions: tuple[Addressed, ...]
    own: np.ndarray
    n_owned: int
    _blocks: dict[int, tuple[int, int]]

    def at(self, array: np.ndarray) -> int:
        """Return the offset of an array of the image."""
        return self._at(address(array))

    def cell(self, table: Table, name: str) -> int:
        """Return the offset of a column of a table."""
        return self.at(table) + WORD * table.layout.columns[name]

    def _at(self, place: int) -> int:
        first = int(np.searchsorted(self._starts, place, "right")) - 1
        start = int(self._starts[first])
        offset, size = self._blocks[start]
        assert first >= 0 and place < start + size, hex(place)
        return offset + place - start

    @cached_property
    def _starts(self) -> np.ndarray:
        return np.array(sorted(self._blocks), dtype=np.int64)

    def relocated(self) -> np.ndarray:
        """Return an instance in memory of its own, with the functions of this process: the words of the block."""
        longer = np.zeros(self.size // WORD + CACHE_LINE // WORD, dtype=np.int64)
        words = longer[-longer.ctypes.data % CACHE_LINE // WORD :][: self.size // WORD]
        words[: len(self.content) // WORD] = np.frombuffer(self.content, dtype=np.int64)
        words[self.links[:, 0] // WORD] = words.ctypes.data + self.links[:, 1]
        words[self.calls[:, 0] // WORD] = [self.functions[k].address for k in self.calls[:, 1]]
        return words


def image_of(tables: Iterable[Table], more: Iterable[np.ndarray] = ()) -> Image:
    """Return the image of some tables and of everything that they reach, and of more arrays."""
    reached = {address(table): table for table in _reached(tables)}
    arrays = [target for table in reached.values() for target in table.links.values() if isinstance(target, np.ndarray)]
    blocks = _blocks([*reached.values(), *arrays, *more])
    stored = {start: ctypes.string_at(start, size) for start, size in blocks.items()}
    order = sorted(blocks, key=lambda start: not any(stored[start]))  # those of zeros at the end
    offsets, size = {}, 0
    for start in order:  # at cache lines, so that the offsets do not depend on the addresses
        offsets[start] = size, blocks[start]
        size += blocks[start] + -blocks[start] % CACHE_LINE
    found = Image(b"", size, *(np.empty((0, 2), dtype=np.int64),) * 2, (), np.empty(0, dtype=np.int64), 0, offsets)
    words = np.zeros(size, dtype=np.uint8)
    for start, (offset, count) in offsets.items():
        words[offset : offset + count] = np.frombuffer(stored[start], dtype=np.uint8)
    words = words.view(np.int64)
    links, calls, functions = [], [], dict[int, tuple[int, Addressed]]()
    owned: list[int] = []
    emptied: list[int] = []
    for table in reached.values():
        first = found.at(table)
        for column, target in table.links.items():
            place = first + WORD * column
            words[place // WORD] = 0
            if not isinstance(target, np.ndarray):
                number, _ = functions.setdefault(target.address, (len(functions), target))
                calls.append((place, number))
            elif target.size:
                links.append((place, found.at(target)))
        addresses, cells = _own(table.layout)
        owned += [first + WORD * column for column in addresses]
        emptied += [first + WORD * column for column in cells]
    words[np.array(owned + emptied, dtype=np.int64) // WORD] = 0
    content = words[: int(np.flatnonzero(words)[-1]) + 1] if words.any() else words[:0]
    return Image(
        content.tobytes(), size, _pairs(links), _pairs(calls), tuple(function for _, function in functions.values()),
        np.array(owned + emptied, dtype=np.int64), len(owned), offsets,
    )  # fmt: skip


def _pairs(found: list[tuple[int, int]]) -> np.ndarray:
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def _reached(tables: Iterable[Table]) -> Iterator[Table]:
    """Yield tables and all that their links lead to, each once."""
    waiting, seen = [*tables], set[int]()
    while waiting:
        table = waiting.pop()
        if not table.size or address(table) in seen:
            continue
        seen.add(address(table))
        yield table
        waiting += [target for target in table.links.values() if isinstance(target, Table)]


def _own(layout: Layout) -> tuple[list[int], list[int]]:
    """Return the columns of arrays that compiled code allocates, and of the cells that describe them."""
    own = [column for name, column in layout.columns.items() if layout[name] in OWN]
    return own, [layout.columns[name] for name in EMPTIED if own and name in layout]


def _blocks(arrays: Iterable[np.ndarray]) -> dict[int, int]:
    """Return the address and the size in bytes of each block of memory, in the order of the arrays.

    Arrays that overlap, as those of a larger one do, belong to one block.
    """
    ends: dict[int, int] = {}
    for array in arrays:
        if array.size:
            start = address(array)
            ends[start] = max(ends.get(start, 0), start + array.nbytes)
    block_of: dict[int, int] = {}
    first = end = 0
    for start in sorted(ends):
        if start >= end:
            first = start
        end = max(end, ends[start])
        block_of[start], ends[first] = first, end
    return {block_of[start]: ends[block_of[start]] - block_of[start] for start in ends}
