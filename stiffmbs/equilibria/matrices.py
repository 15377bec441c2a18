"""Matrices of a balance of forces: dense with a compiled sparse LU in small systems, SciPy's sparse arrays in large ones.

In a small system SciPy's sparse package takes longer to load than the search for an equilibrium.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from ..compile.machine.layout import address, packed_with_memory
from ..compile.machine.native.tables import FACTORS
from ..compile.system import System
from ..compile.terms import TERM_AXES
from ..dynamics.dynamics import FACTOR_AND_SOLVE, Dynamics
from ..sparse.elimination_order import EliminationOrder, factors_of, order_by_blocks
from ..sparse.parameters import MATRICES
from .parameters import EQUILIBRIA

Matrix: TypeAlias = Any
"""ndarray, or sparse array of SciPy."""


def is_small(system: System) -> bool:
    """Return True if the matrices of a system's balances are dense."""
    return system.n_u + len(system.states) + system.n_c <= MATRICES.dense_up_to


def matrix_of(system: System, value: np.ndarray, row: np.ndarray, column: np.ndarray, shape: tuple[int, int]) -> Matrix:
    """Return the matrix with some entries; those at the same place are added."""
    if is_small(system):
        places = row * shape[1] + column
        return np.bincount(places, value, minlength=shape[0] * shape[1]).reshape(shape)
    from scipy.sparse import csc_array

    return csc_array((value, (row, column)), shape=shape)


def term_matrix(dynamics: Dynamics, name: str) -> Matrix:
    """Return a matrix term of the set ``tangent`` from its last evaluation."""
    system, term, axes = dynamics.system, dynamics.system.term("tangent", name), TERM_AXES[name]
    shape = system.extent(axes[0]), system.extent(axes[1])
    return matrix_of(system, dynamics.state.values["tangent"][term.source], term.row, term.column, shape)


def mass_matrix(dynamics: Dynamics) -> Matrix:
    """Return the mass matrix at the last evaluation of the set ``tangent``; that of flexible bodies is not diagonal."""
    diagonal_part = diagonal(dynamics.system, dynamics.system.mass)
    return diagonal_part + term_matrix(dynamics, "inertia") if dynamics.system.has_coupled_inertia else diagonal_part


def zeros(system: System, rows: int, columns: int) -> Matrix:
    """Return a matrix of zeros."""
    nothing = np.empty(0, dtype=np.int64)
    return matrix_of(system, np.empty(0), nothing, nothing, (rows, columns))


def diagonal(system: System, values: np.ndarray) -> Matrix:
    """Return a diagonal matrix."""
    places = np.arange(len(values))
    return matrix_of(system, values, places, places, (len(values), len(values)))


def block_diagonal(system: System, blocks: Sequence[np.ndarray]) -> Matrix:
    """Return a matrix with square blocks on its diagonal."""
    starts = np.cumsum([0, *map(len, blocks)])
    row, column = np.hstack([np.indices(block.shape).reshape(2, -1) + first for block, first in zip(blocks, starts[:-1], strict=True)])  # fmt: skip
    return matrix_of(system, np.concatenate([block.ravel() for block in blocks]), row, column, (starts[-1], starts[-1]))


def joined(blocks: Sequence[Sequence[Matrix | None]]) -> Matrix:
    """Return a matrix of blocks; None is a block of zeros."""
    if any(block is not None and not isinstance(block, np.ndarray) for row in blocks for block in row):
        from scipy.sparse import block_array, csc_array

        return block_array([[None if x is None else csc_array(x) for x in row] for row in blocks], format="csc")
    heights = [next(block.shape[0] for block in row if block is not None) for row in blocks]
    widths = [next(block.shape[1] for block in column if block is not None) for column in zip(*blocks, strict=True)]
    whole = np.zeros((sum(heights), sum(widths)))
    ends = np.cumsum([0, *heights]), np.cumsum([0, *widths])
    for i, row in enumerate(blocks):
        for j, block in enumerate(row):
            if block is not None:
                whole[ends[0][i] : ends[0][i + 1], ends[1][j] : ends[1][j + 1]] = block
    return whole


def scaled(factors: np.ndarray, matrix: Matrix) -> Matrix:
    """Return a matrix with its rows multiplied by factors."""
    if isinstance(matrix, np.ndarray):
        return factors[:, None] * matrix
    from scipy.sparse import diags_array

    return diags_array(factors) @ matrix


def product(left: Matrix, right: Matrix) -> Matrix:
    """Return a product of matrices with few nonzero entries in each column of `right`."""
    if not isinstance(right, np.ndarray):
        return left @ right
    row, column, value = _by_columns(right)
    counts = np.bincount(column, minlength=right.shape[1])
    first, found = np.cumsum(counts) - counts, np.zeros((left.shape[0], right.shape[1]))
    for k in range(counts.max(initial=0)):
        into = np.flatnonzero(counts > k)
        at = first[into] + k
        found[:, into] += left[:, row[at]] * value[at]
    return found


def _by_columns(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return row, column and value of the nonzero entries, sorted by columns."""
    turned = np.ascontiguousarray(matrix.T)
    places = np.flatnonzero(turned != 0.0)
    column, row = np.divmod(places, matrix.shape[0])
    return row, column, turned.ravel()[places]


def dense(matrix: Matrix) -> np.ndarray:
    """Return a matrix as an ndarray."""
    return matrix if isinstance(matrix, np.ndarray) else np.asarray(matrix.toarray())


def solution(dynamics: Dynamics, matrix: Matrix, right: np.ndarray, n: int) -> np.ndarray | None:
    """Return the solution of a bordered system, or None if its matrix is singular.

    The first `n` unknowns are velocities, or velocities and states. The multipliers of the independent equations are
    next, and then any others.
    """
    if not isinstance(matrix, np.ndarray):
        from scipy.sparse.linalg import splu

        try:
            return np.asarray(splu(matrix).solve(right))
        except RuntimeError:  # exactly singular
            return None
    system, size = dynamics.system, len(right)
    order = dynamics.once(_order)
    at = np.empty(len(order.unknowns), dtype=np.int64)
    at[order.unknowns] = np.arange(len(at))
    multipliers = at[system.n_u + len(system.states) + np.flatnonzero(system.active)]
    at = np.concatenate([at[:n], multipliers, np.full(size - n - len(multipliers), len(at))])
    row, column, value = _by_columns(matrix)
    order = EliminationOrder(np.argsort(at, kind="stable"), order.fill, order.updates)
    factors = factors_of(size, row, column, order) | {"a": value}
    table, found = packed_with_memory(FACTORS, factors), right.copy()
    if FACTOR_AND_SOLVE.short_call(address(found), address(table)) == 0 and _solves(matrix, right, found):
        return found
    try:  # the fixed order of elimination may lack pivots where equations are nearly dependent
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return None


def _order(dynamics: Dynamics) -> EliminationOrder:
    return order_by_blocks(dynamics.system)


def _solves(matrix: np.ndarray, right: np.ndarray, found: np.ndarray) -> bool:
    """Return True if the residual of a solution is small compared with its terms."""
    terms = np.max(np.abs(matrix) @ np.abs(found) + np.abs(right), initial=0.0)
    return bool(np.max(np.abs(matrix @ found - right), initial=0.0) <= EQUILIBRIA.no_effect * terms)
