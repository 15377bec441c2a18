"""Cholesky factors of stiffness matrices, by nested dissection and the multifrontal method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, maximum_bipartite_matching

LARGEST_PART = 64
"""Largest number of nodes that are eliminated without a further division."""
COLUMNS = 256
"""Columns of a matrix that are added together, so that they stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class Front:
    """Factors of rows that are eliminated together, and of the later rows that they change."""

    # begin, end: eliminated rows
    begin: int
    end: int
    later: np.ndarray  # of int, shape (m,): changed rows, in increasing order
    own: np.ndarray  # shape (end - begin, end - begin): factor of the eliminated rows, a lower triangle
    below: np.ndarray  # shape (m, end - begin): factor of the later rows


class Cholesky:
    """Factors L L^T of a symmetric positive definite matrix with the same number c of rows for each of n nodes.

    `matrix` of shape (c n, c n). `points` of shape (n, 3): positions of the nodes. Raises numpy.linalg.LinAlgError if it is not positive definite.

    A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973) 345-363.
    J. W. H. Liu, The multifrontal method for sparse matrix solution, SIAM Review 34 (1992) 82-109.
    """

    def __init__(self, matrix: csc_array, points: np.ndarray) -> None:
        parts = dissection(matrix, points)
        nodes = np.concatenate([np.empty(0, dtype=np.int64), *parts])
        width = matrix.shape[0] // max(1, len(points))
        self._order = (width * nodes[:, None] + np.arange(width)).ravel()
        ends = np.cumsum([width * len(part) for part in parts])
        self._fronts = _fronts(csc_array(matrix[self._order][:, self._order]), ends.tolist())

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the solutions for right-hand sides, shape (c n,) or (c n, k)."""
        x = np.atleast_2d(right.T).T[self._order]
        for front in self._fronts:
            part = dtrsm(1.0, front.own, x[front.begin : front.end], lower=1)
            x[front.begin : front.end] = part
            x[front.later] -= front.below @ part
        for front in reversed(self._fronts):
            part = x[front.begin : front.end] - front.below.T @ x[front.later]
            x[front.begin : front.end] = dtrsm(1.0, front.own, part, lower=1, trans_a=1)
        found = np.empty_like(x)
        found[self._order] = x
        return found.reshape(right.shape)


def _fronts(matrix: csc_array, ends: list[int]) -> list[Front]:
    """Factor a matrix whose rows are eliminated in their order, in groups with these ends."""
    found: list[Front] = []
    place, begin = np.empty(matrix.shape[0], dtype=np.int64), 0
    waiting: list[tuple[np.ndarray, np.ndarray]] = []  # Schur complements, lower triangles, with their rows
    for end in ends:
        entries = slice(matrix.indptr[begin], matrix.indptr[end])
        row, value = matrix.indices[entries], matrix.data[entries]
        column = np.repeat(np.arange(end - begin), np.diff(matrix.indptr[begin : end + 1]))
        parts = [each for each in waiting if each[0][0] < end]
        waiting = [each for each in waiting if each[0][0] >= end]
        rows = np.unique(np.concatenate([row[row >= begin], *(rows for rows, _ in parts)]))
        k, later = end - begin, rows[end - begin :]
        place[rows] = np.arange(len(rows))
        front = np.zeros((len(rows), k), order="F")
        front[place[row[row >= begin]], column[row >= begin]] = value[row >= begin]
        complement = np.zeros((len(later), len(later)), order="F")
        while parts:
            rows, part = parts.pop()
            at, own = place[rows], int(np.searchsorted(rows, end))
            _add_lower(front, at, part[:, :own])
            _add_lower(complement, at[own:] - k, part[own:, own:])
        factor, failed = dpotrf(front[:k], lower=1, clean=0)
        if failed:
            raise np.linalg.LinAlgError(f"the matrix is not positive definite: row {begin + failed - 1}")
        below = dtrsm(1.0, factor, front[k:], side=1, lower=1, trans_a=1)
        if len(later):
            waiting.append((later, dsyrk(-1.0, below, beta=1.0, c=complement, lower=1, overwrite_c=1)))
        found.append(Front(begin, end, later, factor, below))
        begin = end
    return found


def _add_lower(target: np.ndarray, at: np.ndarray, part: np.ndarray) -> None:
    """Add the lower triangle of a part to rows and columns `at`, in increasing order, of a matrix in Fortran order.

    The upper triangle of the target, which the factors do not use, is changed as well.
    """
    for first in range(0, part.shape[1], COLUMNS):
        columns = at[first : min(first + COLUMNS, part.shape[1])]
        spread = np.zeros((len(columns), target.shape[0] - at[first]))
        spread[:, at[first:] - at[first]] = part[first:, first : first + COLUMNS].T
        target.T[columns, at[first] :] += spread


def dissection(matrix: csc_array, points: np.ndarray) -> list[np.ndarray]:
    """Return the nodes in parts, in the order of elimination: a separator of two halves comes after both.

    `matrix` of shape (c n, c n), `points` of shape (n, 3).
    """
    width = max(1, matrix.shape[0] // max(1, len(points)))
    blocks = matrix.tobsr((width, width))
    entries = np.ones(len(blocks.indices), dtype=np.int8), blocks.indices, blocks.indptr
    graph = csr_array(entries, shape=(len(points), len(points)))
    parts: list[np.ndarray] = []
    waiting = [(np.arange(len(points)), True)]
    while waiting:
        nodes, divided = waiting.pop()
        if len(nodes) <= LARGEST_PART or not divided:
            parts.append(nodes)
            continue
        along = points[nodes, np.argmax(np.ptp(points[nodes], axis=0))]
        above = along >= np.median(along)
        if above.all():
            above = np.arange(len(nodes)) >= len(nodes) // 2
        between = _separator(csr_array(graph[nodes][:, nodes]), above)
        waiting += [(nodes[between], False), (nodes[above & ~between], True), (nodes[~above & ~between], True)]
    return [part for part in parts if len(part)]


def _separator(graph: csr_array, above: np.ndarray) -> np.ndarray:
    """Return the fewest nodes on the edges between two sides: the minimum vertex cover of these (Konig's theorem)."""
    low, high = np.flatnonzero(~above), np.flatnonzero(above)
    edges = csr_array(graph[low][:, high])
    low, high = low[np.diff(edges.indptr) > 0], high[np.unique(edges.indices)]
    edges = graph[low][:, high].tocoo()
    partner = maximum_bipartite_matching(edges.tocsr(), perm_type="column")
    # paths from unmatched low nodes, by edges upwards and by pairs of the matching downwards
    n, start = len(low), len(low) + len(high)
    paired, single = np.flatnonzero(partner >= 0), np.flatnonzero(partner < 0)
    tails = np.concatenate([edges.row, n + partner[paired], np.full(len(single), start)])
    heads = np.concatenate([n + edges.col, paired, single])
    steps = csr_array((np.ones(len(tails), dtype=np.int8), (tails, heads)), shape=(start + 1, start + 1))
    reached = np.zeros(start + 1, dtype=bool)
    reached[breadth_first_order(steps, start, return_predecessors=False)] = True
    found = np.zeros(len(above), dtype=bool)
    found[low[~reached[:n]]] = found[high[reached[n:start]]] = True
    return found
