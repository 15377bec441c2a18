"""Which blocks of a matrix are filled when whole nodes are eliminated one after the other, and where they are stored.

A node is a set of unknowns that are eliminated together.  Node k has two panels: one with its columns from the diagonal
down, transposed, one with its rows right of the diagonal, and behind these room for a block of its own size.  Blocks in them begin at whole quads, filled up with zeros.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np

QUAD = 4
"""Floats that are computed with at once (`stiffmbs.compile.machine.native.quads`)."""
CACHE_LINE = 64
"""Bytes that a processor loads at a time."""


def at_a_line(count: int) -> np.ndarray:
    """Zeros that begin with a cache line: quads that lie in two of them are written and read again far more slowly."""
    longer = np.zeros(count + CACHE_LINE // 8)
    first = -longer.ctypes.data % CACHE_LINE // 8
    return longer[first : first + count]


def padded(size: int) -> int:
    """The size, rounded up to whole quads."""
    return -(-size // QUAD) * QUAD


@dataclass(frozen=True)
class Blocks:
    """Blocks of the factors of a matrix without pivoting.

    Attributes
    ----------
    nodes : sequence of ndarray of int
        The unknowns of each node, in the order of elimination.
    below, right : lists of list of int
        For each node the later nodes whose rows its columns have, and whose columns its rows have.
    """

    nodes: Sequence[np.ndarray]
    below: list[list[int]]
    right: list[list[int]]

    @cached_property
    def sizes(self) -> list[int]:
        """Unknowns of each node."""
        return [len(node) for node in self.nodes]

    @cached_property
    def widths(self) -> list[int]:
        """The same, filled up to whole quads."""
        return [padded(size) for size in self.sizes]

    @cached_property
    def down_at(self) -> list[dict[int, int]]:
        """For each node, where in a line of its first panel each block begins, its own at 0."""
        return [self._offsets([k, *below]) for k, below in enumerate(self.below)]

    @cached_property
    def right_at(self) -> list[dict[int, int]]:
        """The same of its second panel."""
        return [self._offsets(right) for right in self.right]

    @cached_property
    def down_width(self) -> list[int]:
        """Length of a line of each first panel."""
        return [self.widths[k] + sum(self.widths[a] for a in below) for k, below in enumerate(self.below)]

    @cached_property
    def right_width(self) -> list[int]:
        """Length of a line of each second panel."""
        return [sum(self.widths[b] for b in right) for right in self.right]

    @cached_property
    def starts(self) -> np.ndarray:
        """Where each node's panels begin, first and second in turn, and where the last ends with the room behind it."""
        second = [width + right for width, right in zip(self.widths, self.right_width, strict=True)]
        lengths = [
            size * width for size, *both in zip(self.sizes, self.down_width, second, strict=True) for width in both
        ]
        return np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)])

    @cached_property
    def places(self) -> np.ndarray:
        """Where each unknown stands in a vector whose nodes begin at whole quads."""
        place = np.empty(sum(self.sizes), dtype=np.int64)
        for start, node in zip(self.node_starts, self.nodes, strict=False):
            place[node] = start + np.arange(len(node))
        return place

    @cached_property
    def node_starts(self) -> list[int]:
        """Where each node begins in such a vector, and where the last ends."""
        return np.concatenate([[0], np.cumsum(self.widths, dtype=np.int64)]).tolist()

    def quads(self, name: str, nodes: list[list[int]]) -> dict[str, np.ndarray]:
        """For each node where the quads of other nodes stand in a vector, and where each node's list begins."""
        listed = [
            [self.node_starts[a] + shift for a in others for shift in range(0, self.widths[a], QUAD)]
            for others in nodes
        ]
        ends = np.cumsum([0, *map(len, listed)], dtype=np.int64)
        return {f"{name}_x": np.array([at for part in listed for at in part], dtype=np.int64), f"{name}_at": ends}

    def slots(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Where the entries of the matrix stand in the panels."""
        n = len(self.nodes)
        node, within = np.empty(sum(self.sizes), dtype=np.int64), np.empty(sum(self.sizes), dtype=np.int64)
        for k, own in enumerate(self.nodes):
            node[own], within[own] = k, np.arange(len(own))
        pairs, pair = np.unique(node[rows] * n + node[columns], return_inverse=True)
        starts, by_row, by_column = np.array([self._block(*divmod(both, n)) for both in pairs.tolist()]).T
        slots: np.ndarray = starts[pair] + by_row[pair] * within[rows] + by_column[pair] * within[columns]
        return slots.astype(np.int32)

    def _block(self, row: int, column: int) -> tuple[int, int, int]:
        """Where the block of two nodes begins, and the strides of its rows and columns."""
        if row >= column:
            return int(self.starts[2 * column]) + self.down_at[column][row], 1, self.down_width[column]
        return int(self.starts[2 * row + 1]) + self.right_at[row][column], self.right_width[row], 1

    def _offsets(self, nodes: Sequence[int]) -> dict[int, int]:
        return dict(zip(nodes, accumulate((self.widths[a] for a in nodes), initial=0), strict=False))


def filled(nodes: Sequence[np.ndarray], rows: np.ndarray, columns: np.ndarray) -> Blocks:
    """The blocks that are filled when the nodes are eliminated in their order.

    Parameters
    ----------
    nodes : sequence of ndarray of int
        Each unknown is in one of them.
    rows, columns : ndarrays of int
        The entries of the matrix.

    References
    ----------
    Duff and Reid, The multifrontal solution of unsymmetric sets of linear equations, SIAM J. Sci. Stat. Comput. 5
    (1984) 633-641: dense blocks along an order that is fixed beforehand.  Here the blocks are updated in place.
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
    return Blocks(nodes, listed_below, listed_right)


def _touching(nodes: Sequence[np.ndarray], rows: np.ndarray, columns: np.ndarray) -> tuple[list[int], list[int]]:
    """For each node the later ones whose rows and whose columns share entries with it, as bits of whole numbers."""
    node = np.empty(sum(map(len, nodes)), dtype=np.int64)
    for k, own in enumerate(nodes):
        node[own] = k
    below, right = [0] * len(nodes), [0] * len(nodes)
    for both in np.unique(node[rows] * len(nodes) + node[columns]).tolist():
        a, b = divmod(both, len(nodes))
        if a > b:
            below[b] |= 1 << a
        elif b > a:
            right[a] |= 1 << b
    return below, right


def _postorder(around: list[int]) -> list[int]:
    """The nodes, each right after those that are eliminated into it, which then are near in memory; nothing more is filled.

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
    while waiting:  # parents before children, from the last to the first: read backwards
        order.append(waiting.pop())
        waiting += children[order[-1]]
    return order[:0:-1]


def _beyond(bits: int, last: int) -> int:
    """Those members of a set that are larger."""
    return (bits >> (last + 1)) << (last + 1)


def _members(bits: int) -> list[int]:
    members = []
    while bits:
        lowest = bits & -bits
        members.append(lowest.bit_length() - 1)
        bits ^= lowest
    return members
