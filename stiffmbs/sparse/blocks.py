"""Block structure of the factors for elimination by supernodes, and its storage.

A supernode is a set of unknowns eliminated together.  It has two panels: its columns from the diagonal down,
transposed, and its rows right of the diagonal with space for a block of its own size.  Blocks begin at four-lane (SIMD)
quads, padded with zeros."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np

from ..compile.machine.layout import QUAD


def padded(size: int) -> int:
    """Return the size rounded up to whole quads."""
    return -(-size // QUAD) * QUAD


@dataclass(frozen=True)
class Blocks:
    """Blocks of the factors of a matrix without pivoting.

    `nodes`: unknowns of each supernode, in the order of elimination. `below`, `right`: later supernodes with blocks in
    the columns and in the rows of each supernode. `parts`: 1, or 2 for complex numbers, stored as pairs; widths, offsets
    and positions count their parts.
    """

    nodes: Sequence[np.ndarray]
    below: list[list[int]]
    right: list[list[int]]
    parts: int = 1

    @cached_property
    def sizes(self) -> list[int]:
        """Return the number of unknowns of each supernode."""
        return [len(node) for node in self.nodes]

    @cached_property
    def widths(self) -> list[int]:
        """Return the lengths of the supernodes' lines, rounded up to whole quads."""
        return [padded(self.parts * size) for size in self.sizes]

    @cached_property
    def down_at(self) -> list[dict[int, int]]:
        """Return the offsets of the blocks in a line of each first panel; its own is at 0."""
        return [self._offsets([k, *below]) for k, below in enumerate(self.below)]

    @cached_property
    def right_at(self) -> list[dict[int, int]]:
        """Return the offsets of the blocks in a line of each second panel."""
        return [self._offsets(right) for right in self.right]

    @cached_property
    def down_width(self) -> list[int]:
        """Return the length of a line of each first panel."""
        return [self.widths[k] + sum(self.widths[a] for a in below) for k, below in enumerate(self.below)]

    @cached_property
    def right_width(self) -> list[int]:
        """Return the length of a line of each second panel."""
        return [sum(self.widths[b] for b in right) for right in self.right]

    @cached_property
    def starts(self) -> np.ndarray:
        """Return the starts of the panels, first and second in turn, and the end of the last."""
        second = [width + right for width, right in zip(self.widths, self.right_width, strict=True)]
        lengths = [
            size * width for size, *both in zip(self.sizes, self.down_width, second, strict=True) for width in both
        ]
        return np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)])

    @cached_property
    def places(self) -> np.ndarray:
        """Return the position of each part of each unknown in a vector whose supernodes begin at whole quads."""
        place = np.empty((sum(self.sizes), self.parts), dtype=np.int64)
        for start, node in zip(self.node_starts, self.nodes, strict=False):
            place[node] = start + np.arange(self.parts * len(node)).reshape(-1, self.parts)
        return place.ravel()

    @cached_property
    def node_starts(self) -> list[int]:
        """Return the start of each supernode in such a vector, and the end of the last."""
        return np.concatenate([[0], np.cumsum(self.widths, dtype=np.int64)]).tolist()

    def quads(self, name: str, nodes: list[list[int]]) -> dict[str, np.ndarray]:
        """Return the positions of the quads of each supernode's neighbours in a vector, and the start of each list."""
        listed = [
            [self.node_starts[a] + shift for a in others for shift in range(0, self.widths[a], QUAD)]
            for others in nodes
        ]
        ends = np.cumsum([0, *map(len, listed)], dtype=np.int64)
        return {f"{name}_x": np.array([at for part in listed for at in part], dtype=np.int64), f"{name}_at": ends}

    def slots(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return the positions of the matrix entries in the panels.

        Complex numbers are given as real blocks of two rows and columns. Their second columns, which follow from the
        first, are stored after the panels.
        """
        n, (row, part), (column, second) = len(self.nodes), divmod(rows, self.parts), divmod(columns, self.parts)
        node, within = np.empty(sum(self.sizes), dtype=np.int64), np.empty(sum(self.sizes), dtype=np.int64)
        for k, own in enumerate(self.nodes):
            node[own], within[own] = k, np.arange(len(own))
        pairs, pair = np.unique(node[row] * n + node[column], return_inverse=True)
        starts, by_row, by_column = np.array([self._block(*divmod(both, n)) for both in pairs.tolist()]).T
        slots = starts[pair] + by_row[pair] * within[row] + by_column[pair] * within[column] + part
        stored: np.ndarray = np.where(second == 0, slots, self.starts[-1]).astype(np.int32)
        return stored

    def _block(self, row: int, column: int) -> tuple[int, int, int]:
        """Return the start of the block of two supernodes, and the strides of its rows and columns."""
        if row >= column:
            return int(self.starts[2 * column]) + self.down_at[column][row], self.parts, self.down_width[column]
        return int(self.starts[2 * row + 1]) + self.right_at[row][column], self.right_width[row], self.parts

    def _offsets(self, nodes: Sequence[int]) -> dict[int, int]:
        return dict(zip(nodes, accumulate((self.widths[a] for a in nodes), initial=0), strict=False))


def filled(nodes: Sequence[np.ndarray], rows: np.ndarray, columns: np.ndarray, parts: int = 1) -> Blocks:
    """Return the nonzero blocks of the factors, with the supernodes in postorder.

    Parameters
    ----------
    nodes : sequence of ndarray of int
        Unknowns of each supernode; each unknown is in one of them.
    rows, columns : ndarrays of int
        Entries of the matrix.
    parts : int
        Parts of a number.

    References
    ----------
    Duff and Reid, The multifrontal solution of unsymmetric sets of linear equations, SIAM J. Sci. Stat. Comput. 5
    (1984) 633-641: dense blocks in a fixed order.  Here, the blocks are updated in place.
    """
    below, right = _touching(nodes, rows, columns)
    order = _postorder([one | other for one, other in zip(below, right, strict=True)])
    nodes = [nodes[k] for k in order]
    below, right = _touching(nodes, rows, columns)
    listed_below, listed_right = [], []
    for k in range(len(nodes)):
        rows_of, columns_of = _members(below[k]), _members(right[k])
        listed_below.append(rows_of)
        listed_right.append(columns_of)
        for b in columns_of:
            below[b] |= _beyond(below[k], b)
        for a in rows_of:
            right[a] |= _beyond(right[k], a)
    return Blocks(nodes, listed_below, listed_right, parts)


def filled_below(below: list[set[int]]) -> list[list[int]]:
    """Return the rows below the diagonal of each column of a symmetric matrix's factor, from those of the matrix."""
    for own in below:
        if own:
            parent = min(own)
            below[parent] |= own - {parent}
    return [sorted(own) for own in below]


def _touching(nodes: Sequence[np.ndarray], rows: np.ndarray, columns: np.ndarray) -> tuple[list[int], list[int]]:
    """Return the later supernodes with entries in each supernode's columns and rows, as bit sets."""
    node = np.empty(sum(map(len, nodes)), dtype=np.int64)
    for k, own in enumerate(nodes):
        node[own] = k
    below, right = [0] * len(nodes), [0] * len(nodes)
    for both in {*(node[rows] * len(nodes) + node[columns]).tolist()}:
        a, b = divmod(both, len(nodes))
        if a > b:
            below[b] |= 1 << a
        elif b > a:
            right[a] |= 1 << b
    return below, right


def _postorder(around: list[int]) -> list[int]:
    """Return the supernodes in postorder of the elimination tree, which keeps the fill-in and improves locality.

    Liu, The role of elimination trees in sparse factorization, SIAM J. Matrix Anal. Appl. 11 (1990) 134-172.
    """
    n = len(around)
    children: list[list[int]] = [[] for _ in range(n + 1)]
    for k in range(n):
        parent = (around[k] & -around[k]).bit_length() - 1 if around[k] else n
        children[parent].append(k)
        if parent < n:
            around[parent] |= _beyond(around[k], parent)
    order, waiting = [], [n]
    while waiting:  # parents before children, reversed below
        order.append(waiting.pop())
        waiting += children[order[-1]]
    return order[:0:-1]


def _beyond(bits: int, last: int) -> int:
    """Return the members of a set that are larger than `last`."""
    return (bits >> (last + 1)) << (last + 1)


def _members(bits: int) -> list[int]:
    members = []
    while bits:
        lowest = bits & -bits
        members.append(lowest.bit_length() - 1)
        bits ^= lowest
    return members
