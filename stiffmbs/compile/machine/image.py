"""Tables and arrays of a model in one relocatable block of memory.

Compiled code takes all data from tables (`stiffmbs.compile.machine.layout`), which know the objects whose addresses they
contain. An image is a copy of some tables and of everything that they reach. Its addresses are two lists of
relocations, so that a program needs three steps for a new instance: allocate, copy, relocate.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from .layout import CACHE_LINE, OWN, Addressed, Layout, Table, address

WORD = np.dtype(np.int64).itemsize
"""Bytes of a word of a table."""
EMPTIED = ("capacity", "ready")
"""Cells that are zero in tables whose own arrays are not allocated."""


class Block(NamedTuple):
    """Offset of a block of memory in an image, and its size, bytes."""

    offset: int
    size: int


Blocks: TypeAlias = dict[int, Block]
"""Blocks of memory by their addresses."""


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
    _blocks: Blocks

    def at(self, array: np.ndarray) -> int:
        """Return the offset of an array of the image."""
        return _offset(self._blocks, array)

    def cell(self, table: Table, name: str) -> int:
        """Return the offset of a column of a table."""
        return self.at(table) + WORD * table.layout.columns[name]

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
    reached = list(_reached(tables))
    arrays = [target for table in reached for target in table.links.values() if isinstance(target, np.ndarray)]
    blocks, words = _copied(_blocks([*reached, *arrays, *more]))
    links: list[tuple[int, int]] = []
    calls: list[tuple[int, int]] = []
    functions: dict[int, tuple[int, Addressed]] = {}
    owned: list[int] = []
    emptied: list[int] = []
    for table in reached:
        first = _offset(blocks, table)
        for column, target in table.links.items():
            place = first + WORD * column
            words[place // WORD] = 0
            if not isinstance(target, np.ndarray):
                number, _ = functions.setdefault(target.address, (len(functions), target))
                calls.append((place, number))
            elif target.size:
                links.append((place, _offset(blocks, target)))
        addresses, cells = _own(table.layout)
        owned += [first + WORD * column for column in addresses]
        emptied += [first + WORD * column for column in cells]
    words[np.array(owned + emptied, dtype=np.int64) // WORD] = 0
    filled = np.flatnonzero(words)
    return Image(
        words[: filled[-1] + 1 if len(filled) else 0].tobytes(), WORD * len(words), _pairs(links), _pairs(calls),
        tuple(function for _, function in functions.values()), np.array(owned + emptied, dtype=np.int64), len(owned), blocks,
    )  # fmt: skip


def _copied(sizes: dict[int, int]) -> tuple[Blocks, np.ndarray]:
    """Return the places of blocks in an image, and their content; those of zeros are at the end.

    Blocks begin at cache lines, so that their offsets do not depend on their addresses.
    """
    stored = {start: ctypes.string_at(start, size) for start, size in sizes.items()}
    blocks, end = {}, 0
    for start in sorted(sizes, key=lambda start: not any(stored[start])):
        blocks[start] = Block(end, sizes[start])
        end += sizes[start] + -sizes[start] % CACHE_LINE
    words = np.zeros(end, dtype=np.uint8)
    for start, block in blocks.items():
        words[block.offset : block.offset + block.size] = np.frombuffer(stored[start], dtype=np.uint8)
    return blocks, words.view(np.int64)


def _offset(blocks: Blocks, array: np.ndarray) -> int:
    """Return the offset of an array in an image."""
    place = address(array)
    start = max(start for start in blocks if start <= place)
    assert place < start + blocks[start].size, hex(place)
    return blocks[start].offset + place - start


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
