"""Solutions of [M J^T; J 0] [x; w] = [a; b] for several right sides at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compile.state import State


def saddle_solution(state: State, term_set: str, right: np.ndarray, friction: bool = False) -> np.ndarray:
    """The solution at the state whose terms have just been computed; multipliers of redundant equations are zero.

    Parameters
    ----------
    state : State
    term_set : str
        One that J is in.
    right : ndarray, shape (n_u + n_c, k)
    friction : bool
        Whether forces that depend on multipliers are taken to the left side: J^T - f_lam in place of J^T.
    """
    from scipy.sparse import block_array, csc_array, diags_array
    from scipy.sparse.linalg import splu

    system = state.system
    active = np.flatnonzero(system.active)
    mass, J = diags_array(system.mass), _sparse(state, term_set, "J", (system.n_c, system.n_u))[active]
    by_lam = J.T
    if friction:
        by_lam = by_lam - _sparse(state, term_set, "f_lam", (system.n_u, system.n_c))[:, active]
    matrix = block_array([[mass, by_lam], [J, None]]) if len(active) else mass
    kept = np.concatenate([np.arange(system.n_u), system.n_u + active])
    found = np.zeros_like(right)
    found[kept] = splu(csc_array(matrix)).solve(np.ascontiguousarray(right[kept]))
    return found


def _sparse(state: State, term_set: str, name: str, shape: tuple[int, int]) -> Any:
    from scipy.sparse import coo_array

    term = state.system.term(term_set, name)
    return coo_array((state.values[term_set][term.source], (term.row, term.column)), shape=shape).tocsr()
