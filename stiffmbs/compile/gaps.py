"""Constraint violations as lengths and angles: displacement or rotation of one body that satisfies an equation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .state import State

MOST_MOVES, CLOSED = 60, 1e-12
"""Limit of Newton steps, and relative violation at which an equation is satisfied."""
TINY = np.finfo(float).tiny


class Gap(NamedTuple):
    """Violation and its unit, empty for an equation of states only."""

    size: float
    unit: str

    def __str__(self) -> str:
        return f"{self.size:.3g} {self.unit}".strip()


def position_gap(state: State, t: float, row: int) -> Gap:
    """Return the translation or rotation of one body that satisfies one position equation.

    An equation may have any unit, as (d . d - L^2)/(2 L) of a rod. Newton's method moves the body with the largest
    derivative, along that derivative. `state`: its coordinates violate the equation; they are restored. `t`: s. `row`:
    the equation.
    """
    system = state.system
    kept = state.q.copy()
    try:
        state.evaluate("motion", t)
        first = C = float(state.vector("motion", "C")[row])
        columns, unit = _moved_body(state, row)
        move = np.zeros(system.of_body.n_u * len(system.bodies))
        for _ in range(MOST_MOVES if unit else 0):
            if abs(C) <= CLOSED * abs(first):
                return Gap(float(np.linalg.norm(move)), unit)
            along = state.matrix("motion", "J")[row, columns]
            step = -C * along / max(float(along @ along), TINY)
            move[columns] += step
            taken = np.zeros_like(move)
            taken[columns] = step
            state.q[: system.n_pose] = system.of_body.moved(state.q[: system.n_pose], taken)
            state.evaluate("motion", t)
            C = float(state.vector("motion", "C")[row])
            if not np.isfinite(C):
                break
    finally:
        state.q[:] = kept
    return Gap(abs(first), "")


def velocity_gap(state: State, t: float, row: int, violation: float) -> Gap:
    """Return the velocity of one body that corrects a violation of one velocity equation."""
    state.evaluate("motion", t)
    columns, unit = _moved_body(state, row)
    slope = float(np.linalg.norm(state.matrix("motion", "J")[row, columns])) if unit else 1.0
    return Gap(abs(violation) / max(slope, TINY), f"{unit}/s" if unit else "")


def _moved_body(state: State, row: int) -> tuple[np.ndarray, str]:
    """Return the columns of the body's translation, or of its rotation if no translation matters, and the unit."""
    system = state.system
    count = system.of_body.n_u * len(system.bodies)
    along = np.abs(state.matrix("motion", "J")[row, :count])
    linear = system.per_velocity(1.0, 0.0)[:count]
    for part, unit in ((linear, "m"), (1.0 - linear, "rad")):
        found = np.flatnonzero(part * along > CLOSED)
        if len(found):
            body = int(np.argmax((part * along).reshape(len(system.bodies), -1).max(axis=1)))
            places = np.arange(count).reshape(len(system.bodies), -1)[body]
            return places[part[places] > 0], unit
    return np.empty(0, dtype=int), ""
