"""Constraint equations that are linear with constant coefficients, and the coordinates that they save.

An equation in one coordinate holds it still; one in two ties them in a constant ratio, and so do two in three.  Such
equations need no multiplier while the motion is solved for: a cart on a rail keeps one coordinate.  As in the presolve of
linear programs (Andersen, Andersen, Presolving in linear programming, Math. Program. 71 (1995) 221-245: singleton rows
and doubleton equations), each one found may turn others into one.  In space three equations in one orientation hold it
still.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

import numpy as np

from ..describe.element import Element
from ..describe.formula_field import TIME, Formula
from ..describe.table import Table
from .coordinates import STILL, Coordinates
from .relations import INDEPENDENT, SAME, Relations
from .state import State
from .system import System, Term

PROBES = 2
"""Random poses at which a derivative must have the value of the start to be taken for a constant.  The equations are
analytic and the poses are random, so that two agree by chance with probability zero."""
CORNERED = {"abs", "sign", "min", "max", "step", "step5", "branch"}
"""Functions of formulas that are not analytic."""


def independent_coordinates(system: System, state: State, t: float) -> Coordinates:
    """The coordinates that remain when equations with constant coefficients are used to leave out others.

    Parameters
    ----------
    system : System
    state : State
        At a pose that satisfies the constraints; left as it is.
    t : float
        s.
    """
    candidates = _candidates(system)
    found = Relations.none(system)
    term = system.term("position", "C_q")
    if not candidates.any():
        return found.coordinates(system)
    entries = np.flatnonzero(candidates[term.row])
    term = Term(term.source[entries], term.row[entries], term.column[entries])
    while True:
        values = _derivatives(term, found, state, t)
        straight = found.extended(_constant_rows(term, found, values, system))
        if not (found.turned(_held_orientations(term, found, values, system), system) or straight):
            return found.coordinates(system)


def _candidates(system: System) -> np.ndarray:
    """Rows that may be left out: solved for, with a position form, analytic, without time, in no force of friction.

    Multipliers that forces depend on are needed.
    """
    rows = system.active & system.holonomic
    for group in system.groups:
        if group.record.n_equations and not _analytic(group.elements[0]):
            rows[group.first_row : group.first_row + group.count * group.record.n_equations] = False
    if any(group.record.patterns.get("f_lam") for group in system.groups):
        rows[system.term("tangent", "f_lam").column] = False
    return rows


def _analytic(element: Element) -> bool:
    """Whether equations are analytic in the coordinates and know no time: tables and some functions have corners.

    Elements of one kind have the same formulas but for their numbers.
    """
    names = {
        node.id
        for _, formula in element.parts(Formula)
        for node in ast.walk(formula.tree)
        if isinstance(node, ast.Name)
    }
    tables = any(True for _ in element.parts(Table)) or any(f.tables for _, f in element.parts(Formula))
    return not tables and not names & {TIME, *CORNERED}


def _constant_rows(
    term: Term, found: Relations, values: np.ndarray, system: System
) -> dict[int, list[tuple[int, float]]]:
    """The rows whose derivatives by all coordinates that move are constants: by row the columns and these constants.

    Those by quaternions have to be zero.
    """
    moves, negligible = found.leader[term.column] != STILL, _negligible(term, values, system)
    straight, _ = system.of_body.straight(len(system.bodies))
    change = values.max(axis=0) - values.min(axis=0)
    varies = moves & ~(change <= negligible)  # also where a probe has no value
    counts = moves & (np.abs(values[0]) > negligible)
    excluded = found.fulfilled.copy()
    excluded[term.row[varies | (counts & ~np.isin(term.column, straight))]] = True
    kept = counts & ~excluded[term.row]
    rows: dict[int, list[tuple[int, float]]] = {}
    for row, column, value in zip(term.row[kept].tolist(), term.column[kept].tolist(), values[0][kept], strict=True):
        rows.setdefault(row, []).append((column, float(value)))
    return rows


def _held_orientations(
    term: Term, found: Relations, values: np.ndarray, system: System
) -> Iterator[tuple[int, list[int]]]:
    """Bodies that three rows hold, which depend on nothing that moves but the body's orientation, and these rows.

    Where such rows are independent, the orientation that fulfils them is isolated.
    """
    of_body = system.of_body
    if of_body.n_q == of_body.n_u:
        return
    counts = (found.leader[term.column] != STILL) & ~(np.abs(values).max(axis=0) <= _negligible(term, values, system))
    row, column, derivative = term.row[counts], term.column[counts], values[0][counts]
    body, place = column // of_body.n_q, column % of_body.n_q
    least, most = np.full(system.n_c, len(system.bodies)), np.full(system.n_c, -1)
    np.minimum.at(least, row, np.where(place < of_body.linear, -1, body))
    np.maximum.at(most, row, body)
    for held in np.unique(most[(least == most) & ~found.fulfilled]).tolist():
        rows = np.flatnonzero((most == held) & (least == held) & ~found.fulfilled)
        inside = np.isin(row, rows)
        C_q = np.zeros((len(rows), of_body.n_q))
        np.add.at(C_q, (np.searchsorted(rows, row[inside]), place[inside]), derivative[inside])
        if len(rows) == 3 and np.linalg.svd(C_q, compute_uv=False)[-1] > INDEPENDENT * np.abs(C_q).max():
            yield held, rows.tolist()


def _negligible(term: Term, values: np.ndarray, system: System) -> np.ndarray:
    """For each entry what is rounding beside the largest in its row, where that has a value."""
    largest = np.zeros(system.n_c)
    np.fmax.at(largest, term.row, np.abs(values).max(axis=0))
    rounding: np.ndarray = SAME * largest[term.row]
    return rounding


def _derivatives(term: Term, found: Relations, state: State, t: float) -> np.ndarray:
    """The derivatives at the pose at hand and at random ones that keep the relations found so far, a row for each."""
    start = state.q.copy()
    number = np.arange(len(start))
    size = state.system.per_coordinate(state.system.size, 1.0)
    rows = []
    for probe in range(1 + PROBES):
        scattered = np.modf(4e4 * np.sin(12.9898 * number + 78.233 * probe))[0]  # no need of numpy.random's 12 ms
        moved = size * (1.0 + 0.5 * scattered) * (probe > 0)
        state.q[:] = start + found.ratio * moved[found.leader]
        state.evaluate("position", t + probe)
        rows.append(state.values["position"][term.source].copy())
    state.q[:] = start
    return np.array(rows)
