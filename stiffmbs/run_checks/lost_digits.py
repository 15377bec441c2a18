"""Stiff forces that the rounding of coordinates changes: by 0.01 N at 1 m for a stiffness of 1e14 N/m."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.state import State
from ..compile.terms import TERM_SETS
from ..dynamics.dynamics import Dynamics, OutputRows
from ..notes import Note, NoteKind
from .parameters import RUN_CHECKS

LOST_DIGITS = NoteKind(
    "lost-digits",
    "the force of '{element}' is known to about {lost:.1g} N only, as are reactions: coordinates have 16 digits, and it is "
    "so stiff; the largest force is {largest:.3g} N",
    "use a joint, or less stiffness",
)


def rounded_forces(state: State, t: float) -> tuple[list[tuple[float, str]], list[tuple[float, str]]]:
    """Return the changes of forces, N, and those of torques, N m, by the rounding of coordinates, with their elements.

    Torques are those about the centres of mass of bodies; a torque about the origin of the ground has any lever.
    """
    system, of_body = state.system, state.system.of_body
    state.evaluate("tangent", t)
    size = np.append(np.abs(state.q), np.zeros(of_body.n_q))
    rounding = 0.5 * RUN_CHECKS.roundings * np.finfo(float).eps
    at = 1 + TERM_SETS["tangent"].index("f_q")
    forces, torques = [(0.0, "")], [(0.0, "")]
    for g, group in enumerate(system.groups):
        if group.entries["f_q"] and group.kind.element.kind:
            source, rows, column = group.placed("f_q", int(system.places["tangent"][g, at]))
            changes = (rounding * np.abs(state.values["tangent"][source]) * size[column]).reshape(group.count, -1)
            of_bodies = np.where(rows.reshape(changes.shape) < system.n_u, changes, 0.0)
            row, own = np.array(group.record.patterns["f_q"])[:, 0], np.arange(of_body.n_u * group.kind.n_bodies)
            straight = own % of_body.n_u < of_body.linear
            for found, of_entries, which in ((forces, changes, straight), (torques, of_bodies, ~straight)):
                of_rows = of_entries @ (row[:, None] == own[which])
                found += zip(of_rows.max(axis=1, initial=0.0).tolist(), group.names, strict=True)
    return forces, torques


def lost_digits(state: State, t: float) -> tuple[str, float, float]:
    """Return the element whose force rounding changes most, that change, and the largest force of an element on a body, N."""
    system, (changes, _) = state.system, rounded_forces(state, t)
    state.evaluate("motion", t)
    term, linear = system.term("motion", "f"), system.per_velocity(1.0, 0.0) == 1.0
    forces = state.values["motion"][term.source][linear[term.row]]  # of each element: their sums vanish in equilibrium
    lost, element = max(changes)
    return element, lost, float(np.abs(forces).max(initial=0.0))


def lost_digits_notes(dynamics: Dynamics, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on the force that rounding changes most at the end of a run, if that is much; the state is changed."""
    if not len(rows.t):
        return
    state, t = dynamics.state, float(rows.t[-1])
    state.q[:], state.u[:] = rows.q[-1], rows.u[-1]
    name, lost, at_end = lost_digits(state, t)
    if not lost > RUN_CHECKS.lost * at_end:
        return
    linear = dynamics.system.per_velocity(1.0, 0.0) == 1.0
    inertia = np.abs(dynamics.system.mass * rows.acceleration)[:, linear]  # forces may vanish at the end of a run
    largest = max(at_end, float(np.nanmax(inertia, initial=0.0)))
    if lost > RUN_CHECKS.lost * largest > 0.0:
        yield LOST_DIGITS(name, lost=lost, largest=largest)
