"""Solution of the block systems for several right-hand sides."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from ..compile.state import State
from ..compile.system import System

Entries = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Row indices, column indices and values."""


def saddle_solution(state: State, term_set: str, right: np.ndarray) -> np.ndarray:
    """Solve [M J^T; J 0] [x; w] = right, shape (n_u + n_c, k), at the state whose terms were just evaluated.

    Multipliers of redundant equations are zero.
    """
    return _solved(state.system, list(_saddle(state, term_set)), right)


def acceleration_solution(state: State, right: np.ndarray) -> np.ndarray:
    """Return the variations of accelerations, multipliers and algebraic states for variations of their equations, as columns.

    The matrix is [M J^T-f_lam -f_x; J 0 0; 0 -z_lam -z_x]: forces, and the equations z of algebraic states, depend on
    multipliers and on algebraic states. The terms of the set ``acceleration`` were just evaluated.
    """
    system = state.system
    places = np.full(system.n_q, -1)
    places[system.algebraic_coordinates] = np.arange(len(system.algebraic_coordinates))
    of_lam, of_x = system.n_u, system.n_u + system.n_c
    blocks = list(_saddle(state, "acceleration"))
    row, column, value = _term(state, "acceleration", "f_lam")
    blocks.append((row, of_lam + column, -value))
    row, column, value = _term(state, "acceleration", "f_alg")
    blocks.append((row, of_x + places[column], -value))
    for name, first, numbers in (("rate_lam", of_lam, np.arange(system.n_c)), ("rate_alg", of_x, places)):
        row, column, value = _term(state, "acceleration", name)
        own = places[row] >= 0
        blocks.append((of_x + places[row[own]], first + numbers[column[own]], -value[own]))
    return _solved(system, blocks, right)


def _saddle(state: State, term_set: str) -> Iterator[Entries]:
    """Yield M, J^T and J."""
    n_u = state.system.n_u
    row, column, value = _term(state, term_set, "J")
    yield np.arange(n_u), np.arange(n_u), state.system.mass
    yield column, n_u + row, value
    yield n_u + row, column, value


def _term(state: State, term_set: str, name: str) -> Entries:
    term = state.system.term(term_set, name)
    return term.row, term.column, state.values[term_set][term.source]


def _solved(system: System, blocks: list[Entries], right: np.ndarray) -> np.ndarray:
    """Solve without the redundant equations and their multipliers, which are zero."""
    kept = np.ones(len(right), dtype=bool)
    kept[system.n_u : system.n_u + system.n_c] = system.active
    place, n = np.cumsum(kept) - 1, int(kept.sum())
    row, column, value = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    used = kept[row] & kept[column]
    row, column, value = place[row[used]], place[column[used]], value[used]
    found = np.zeros_like(right)
    factors = splu(csc_array(coo_array((value, (row, column)), shape=(n, n))))
    found[kept] = factors.solve(np.ascontiguousarray(right[kept]))
    return found
