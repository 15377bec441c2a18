"""Cholesky factors of stiffness matrices, by nested dissection and the multifrontal method."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_blas_funcs, get_lapack_funcs
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, maximum_bipartite_matching

LOGGER = logging.getLogger(__name__)
LARGEST_PART = 64
"""Largest number of nodes that are eliminated without a further division."""
COLUMNS = 256
"""Columns of a matrix that are added together, so that they stay in the processor's cache."""
LARGE = 100_000
"""Rows of a matrix above which its factors are in single precision, where refinement reaches double precision."""
REFINEMENTS = 10
"""Largest number of corrections of a solution by factors in single precision."""
REFINED = 1e-13
"""Size of a correction, relative to the solution, after which no other is added."""


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
    """Factors L L^T of a symmetric positive definite matrix with three rows for each node.

    Factors of a large matrix are in single precision, which halves their memory and time. Iterative refinement with
    residuals in double precision then gives solutions as accurate as those of factors in double precision. Factors are
    in double precision if the matrix is too ill-conditioned for refinement.

    Parameters
    ----------
    matrix : csc_array, shape (3 n, 3 n)
    points : ndarray, shape (n, 3)
        Positions of the nodes.

    Attributes
    ----------
    precision : type
        Numbers of the factors, numpy.float32 or numpy.float64.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not positive definite.

    References
    ----------
    A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973) 345-363.
    J. W. H. Liu, The multifrontal method for sparse matrix solution, SIAM Review 34 (1992) 82-109.
    N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. (2002), ch. 12: iterative refinement.
    Y. Notay, Flexible conjugate gradients, SIAM J. Sci. Comput. 22 (2000) 1444-1460.
    """

    def __init__(self, matrix: csc_array, points: np.ndarray) -> None:
        parts = dissection(matrix, points)
        nodes = np.concatenate([np.empty(0, dtype=np.int64), *parts])
        self._order = (3 * nodes[:, None] + np.arange(3)).ravel()
        ends = np.cumsum([3 * len(part) for part in parts])
        self._matrix, self._ends = matrix, ends.tolist()
        self._factor(np.float32 if matrix.shape[0] > LARGE else np.float64)

    def _factor(self, precision: type) -> None:
        """Compute the factors, in double precision where those in single precision fail."""
        self._fronts: list[Front] = []  # frees earlier factors
        ordered = csc_array(self._matrix[self._order][:, self._order])
        self.precision = precision
        LOGGER.info("computing factors in %s precision", precision.__name__)
        try:
            self._fronts = _fronts(ordered, self._ends, precision)
        except np.linalg.LinAlgError:
            if precision == np.float64:
                raise
            self._factor(np.float64)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the solutions for right-hand sides, shape (3 n,) or (3 n, k)."""
        given = np.atleast_2d(right.T).T
        found = self._refined(given) if self.precision == np.float32 else self._solve(given)
        if found is None:
            self._factor(np.float64)
            found = self._solve(given)
        return found.reshape(right.shape)

    def _refined(self, right: np.ndarray) -> np.ndarray | None:
        """Return solutions by conjugate gradients with the factors as preconditioner, or None if these do not converge."""
        found, residual = np.zeros_like(right), right
        change = direction = self._solve(right)
        for _ in range(REFINEMENTS):
            force, work = self._matrix @ direction, _by_columns(residual, change)
            step = work / np.maximum(_by_columns(direction, force), np.finfo(float).tiny)
            found, residual = found + step * direction, residual - step * force
            sizes = [np.sqrt(_by_columns(each, each)) for each in (step * direction, found)]
            if (sizes[0] <= REFINED * sizes[1]).all():
                return found
            last, change = change, self._solve(residual)
            # rounding makes the preconditioner nonlinear: Polak and Ribiere's formula
            share = _by_columns(residual, change - last) / np.where(work > 0, work, 1.0)
            direction = change + share * direction
        return None

    def _solve(self, right: np.ndarray) -> np.ndarray:
        """Return solutions with the precision of the factors, shape (3 n, k)."""
        trsm = get_blas_funcs("trsm", dtype=self.precision)
        scale = np.maximum(np.abs(right).max(axis=0, initial=0.0), np.finfo(float).tiny)
        x = (right[self._order] / scale).astype(self.precision)
        for front in self._fronts:
            part = trsm(1.0, front.own, x[front.begin : front.end], lower=1)
            x[front.begin : front.end] = part
            x[front.later] -= front.below @ part
        for front in reversed(self._fronts):
            part = x[front.begin : front.end] - front.below.T @ x[front.later]
            x[front.begin : front.end] = trsm(1.0, front.own, part, lower=1, trans_a=1)
        found = np.empty(x.shape)
        found[self._order] = x * scale
        return found


def _by_columns(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->j", first, second)  # type: ignore[no-any-return]


def _fronts(matrix: csc_array, ends: list[int], precision: type) -> list[Front]:
    """Factor a matrix whose rows are eliminated in their order, in groups with these ends."""
    trsm, syrk = get_blas_funcs(("trsm", "syrk"), dtype=precision)
    potrf = get_lapack_funcs("potrf", dtype=precision)
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
        front: np.ndarray = np.zeros((len(rows), k), precision, order="F")
        front[place[row[row >= begin]], column[row >= begin]] = value[row >= begin]
        complement: np.ndarray = np.zeros((len(later), len(later)), precision, order="F")
        while parts:
            rows, part = parts.pop()
            at, own = place[rows], int(np.searchsorted(rows, end))
            _add_lower(front, at, part[:, :own])
            _add_lower(complement, at[own:] - k, part[own:, own:])
        factor, failed = potrf(front[:k], lower=1, clean=0)
        if failed:
            raise np.linalg.LinAlgError(f"the matrix is not positive definite: row {begin + failed - 1}")
        below = trsm(1.0, factor, front[k:], side=1, lower=1, trans_a=1)
        if len(later):
            waiting.append((later, syrk(-1.0, below, beta=1.0, c=complement, lower=1, overwrite_c=1)))
        found.append(Front(begin, end, later, factor, below))
        begin = end
    return found


def _add_lower(target: np.ndarray, at: np.ndarray, part: np.ndarray) -> None:
    """Add the lower triangle of a part to rows and columns `at`, in increasing order, of a matrix in Fortran order.

    The upper triangle of the target, which the factors do not use, is changed as well.
    """
    for first in range(0, part.shape[1], COLUMNS):
        columns = at[first : min(first + COLUMNS, part.shape[1])]
        spread = np.zeros((len(columns), target.shape[0] - at[first]), target.dtype)
        spread[:, at[first:] - at[first]] = part[first:, first : first + COLUMNS].T
        target.T[columns, at[first] :] += spread


def dissection(matrix: csc_array, points: np.ndarray) -> list[np.ndarray]:
    """Return the nodes in parts, in the order of elimination: a separator of two halves comes after both.

    Parameters
    ----------
    matrix : csc_array, shape (3 n, 3 n)
    points : ndarray, shape (n, 3)
    """
    blocks = matrix.tobsr((3, 3))
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
