"""Derivatives of accelerations, multipliers and algebraic states with respect to state and parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from ..compile.directional.direction import Direction, Numbers, unchanged
from ..compile.directional.source import STATE
from ..compile.state import State
from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.storage import FAILURES
from ..errors import SolverError


@dataclass(frozen=True)
class Change:
    """Variation of a state, one row for each direction.

    `q`, `u` of shapes (directions, n_q), (directions, n_u): variations of coordinates and velocities, with algebraic
    states that satisfy their equations. `acceleration`, `lam` of shapes (directions, n_u), (directions, n_c).
    """

    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray


class BlockSystem:
    """Block system of a state in several directions."""

    def __init__(self, dynamics: Dynamics, directions: Sequence[Numbers]) -> None:
        self._dynamics, self._numbers = dynamics, directions
        self._accelerations = [Direction(dynamics.state, "acceleration", numbers) for numbers in directions]
        self._by_time = Direction(dynamics.state, "acceleration", unchanged(dynamics.system), STATE)
        self._outputs: list[Direction] = []

    def change(
        self, t: float, q: np.ndarray, u: np.ndarray, moved_q: np.ndarray, moved_u: np.ndarray, moved_t: np.ndarray
    ) -> Change:
        """Return the variations of accelerations, multipliers and algebraic states at a state.

        `moved_q`, `moved_u` of shapes (directions, n_q), (directions, n_u): variations of the state; columns of
        algebraic states are ignored. `moved_t` of shape (directions,): variation of time. Raises SolverError when the
        accelerations are not determined.
        """
        return self._change(t, (q, u), self._accelerations, moved_q, moved_u, moved_t)

    def motion(self, t: float, q: np.ndarray, u: np.ndarray, q_rates: np.ndarray, acceleration: np.ndarray) -> Change:
        """Return the time derivatives of all parts of a state, one row; errors as for `change`."""
        return self._change(t, (q, u), [self._by_time], q_rates[None], acceleration[None], np.ones(1))

    def _change(
        self, t: float, at: tuple[np.ndarray, np.ndarray], directions: Sequence[Direction],
        moved_q: np.ndarray, moved_u: np.ndarray, moved_t: np.ndarray,
    ) -> Change:  # fmt: skip
        state, system = self._dynamics.state, self._dynamics.system
        acceleration = acceleration_at(self._dynamics, t, *at)
        state.a[:] = acceleration
        algebraic, right = system.algebraic_coordinates, []
        for direction, of_q, of_u, of_t in zip(directions, moved_q, moved_u, moved_t, strict=True):
            direction.q[:], direction.u[:] = of_q, of_u
            direction.q[algebraic] = 0.0
            direction.evaluate(t, of_t)
            force = (
                direction.vector("f") - direction.numbers.mass * acceleration - direction.product("inertia", acceleration)
                - direction.product("J", state.lam, True)
            )  # fmt: skip
            constraints = direction.vector("gamma") - direction.product("J", acceleration)
            right.append(np.concatenate([force, constraints, direction.vector("rate")[algebraic]]))
        accelerations, lam, states = np.split(
            acceleration_solution(state, np.array(right).T).T, [system.n_u, system.n_u + system.n_c], axis=1
        )
        found_q = moved_q.copy()
        found_q[:, algebraic] = states
        return Change(found_q, moved_u, accelerations, lam)

    def outputs(self, t: float, change: Change) -> np.ndarray:
        """Return the variations of the output terms at the current state, shape (directions, values)."""
        self._outputs = self._outputs or [Direction(self._dynamics.state, "output", each) for each in self._numbers]
        n_values = self._dynamics.system.n_values("output")
        for k, direction in enumerate(self._outputs):
            direction.q[:], direction.u[:], direction.a[:] = change.q[k], change.u[k], change.acceleration[k]
            direction.lam[:] = change.lam[k]
            direction.evaluate(t)
        return np.array([direction.values[:n_values] for direction in self._outputs])


def acceleration_at(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return u' at a state, which becomes the present one with its multipliers."""
    dynamics.state.q[:], dynamics.state.u[:] = q, u
    status, acceleration = dynamics.accelerate(t)
    if status < 0:
        raise SolverError(f"sensitivities: no accelerations were found at t = {t:.9g} s: {FAILURES[status]}")
    return acceleration


Entries = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Row indices, column indices and values."""


def saddle_solution(state: State, right: np.ndarray) -> np.ndarray:
    """Solve [M J^T; J 0] [x; w] = right, shape (n_u + n_c, k), at the state whose terms were just evaluated.

    Multipliers of redundant equations are zero.
    """
    return _solved(state.system, list(_saddle(state, "motion")), right)


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
    yield _term(state, term_set, "inertia")
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
