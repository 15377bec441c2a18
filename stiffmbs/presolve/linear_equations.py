"""Constraint equations that are linear with constant coefficients, and the coordinates that they eliminate.

An equation in one coordinate fixes it. An equation in two coordinates, or two equations in three, relate them by
constant ratios. Such equations need no multiplier during integration: a cart on a rail keeps one coordinate. As in the
presolve of linear programs, each one found may reduce others to such an equation (singleton and doubleton rows:
Andersen, Andersen, Presolving in linear programming, Math. Program. 71 (1995) 221-245). In space, three equations in
one orientation fix it.

A coefficient is constant if its expression contains no coordinate that moves. Values at other poses are no proof: the
derivative of tanh or exp is exactly zero in floating point over wide ranges.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.coordinates import FIXED, Coordinates
from ..compile.state import State
from ..compile.system import System
from .dependence import Dependence, dependence
from .relations import INDEPENDENT, NEGLIGIBLE, Relations


def independent_coordinates(system: System, state: State, t: float) -> Coordinates:
    """Return the coordinates that remain after elimination by equations with constant coefficients.

    Parameters
    ----------
    state : State
        At a pose that satisfies the constraints; it is not changed.
    t : float
        s.
    """
    found = Relations.none(system)
    candidates = _candidates(system)
    if not candidates.any():
        return found.coordinates(system)
    state.evaluate("position", t)
    C_q = dependence(system, system.term("position", "C_q"), state.values["position"])
    while True:
        moves = found.independent_of != FIXED
        open_rows = candidates & ~found.satisfied
        straight = found.extended(_constant_rows(C_q, moves, open_rows, system))
        if not (found.turned(_held_orientations(C_q, moves, open_rows, system), system) or straight):
            return found.coordinates(system)


def _candidates(system: System) -> np.ndarray:
    """Return a mask of removable rows: active, holonomic, without time or breakpoints, and not needed by friction.

    Multipliers on which forces or states depend are needed.
    """
    rows = system.active & system.holonomic
    for group in system.groups:
        of_group = np.zeros(group.record.n_equations, dtype=bool)
        of_group[: group.record.n_holonomic] = group.record.removable
        last = group.first_row + group.count * len(of_group)
        rows[group.first_row : last] &= np.tile(of_group, group.count)
    if system.forces_by_reactions:
        rows[system.term("tangent", "f_lam").column] = False
    if system.states:
        rows[system.term("tangent", "rate_lam").column] = False
    return rows


def _constant_rows(
    C_q: Dependence, moves: np.ndarray, open_rows: np.ndarray, system: System
) -> dict[int, list[tuple[int, float]]]:
    """Return the rows with constant derivatives by all moving coordinates, as columns and constants by row.

    They contain no quaternions.
    """
    straight, _ = system.straight
    counts = moves[C_q.column]
    included = open_rows.copy()
    included[C_q.row[counts & (C_q.varies(moves) | ~np.isin(C_q.column, straight))]] = False
    largest = np.zeros(system.n_c)
    np.fmax.at(largest, C_q.row, np.abs(C_q.value))
    kept = counts & included[C_q.row] & (np.abs(C_q.value) > NEGLIGIBLE * largest[C_q.row])
    rows: dict[int, list[tuple[int, float]]] = {}
    for row, column, value in zip(
        C_q.row[kept].tolist(), C_q.column[kept].tolist(), C_q.value[kept].tolist(), strict=True
    ):
        rows.setdefault(row, []).append((column, value))
    return rows


def _held_orientations(
    C_q: Dependence, moves: np.ndarray, open_rows: np.ndarray, system: System
) -> Iterator[tuple[int, list[int]]]:
    """Yield bodies whose orientation three rows fix, with these rows, which depend on no other moving coordinate.

    If such rows are independent, the orientation that satisfies them is isolated.
    """
    of_body = system.of_body
    if of_body.n_q == of_body.n_u:
        return
    counts = moves[C_q.column] & open_rows[C_q.row]
    row, column, derivative = C_q.row[counts], C_q.column[counts], C_q.value[counts]
    body, place = column // of_body.n_q, column % of_body.n_q
    least, most = np.full(system.n_c, len(system.bodies)), np.full(system.n_c, -1)
    np.minimum.at(least, row, np.where(place < of_body.linear, -1, body))
    np.maximum.at(most, row, body)
    for held in np.unique(most[least == most]).tolist():
        rows = np.flatnonzero((most == held) & (least == held))
        inside = np.isin(row, rows)
        C_q_held = np.zeros((len(rows), of_body.n_q))
        np.add.at(C_q_held, (np.searchsorted(rows, row[inside]), place[inside]), derivative[inside])
        if len(rows) == 3 and np.linalg.svd(C_q_held, compute_uv=False)[-1] > INDEPENDENT * np.abs(C_q_held).max():
            yield held, rows.tolist()
