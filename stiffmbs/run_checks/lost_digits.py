"""Check of forces that the rounding of coordinates changes: 0.01 N at a coordinate of 1 m for a stiffness of 1e14 N/m."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..compile.state import State
from ..compile.terms import TERM_SETS
from ..dynamics.dynamics import Dynamics, OutputRows
from .parameters import RUN_CHECKS


class LostDigits(NamedTuple):
    """Element whose force rounding changes most, that change, and the largest force on a body, N."""

    element: str
    lost: float
    largest: float


def lost_digits(state: State, t: float) -> LostDigits:
    """Return the largest change of a force by the rounding of coordinates at a state."""
    system, found = state.system, [("", 0.0)]
    state.evaluate("tangent", t)
    size, width = np.append(np.abs(state.q), np.zeros(system.of_body.n_q)), system.of_body.n_u
    rounding = 0.5 * RUN_CHECKS.roundings * np.finfo(float).eps
    at = 1 + TERM_SETS["tangent"].index("f_q")
    for g, group in enumerate(system.groups):
        if group.entries["f_q"] and group.kind.element.kind:
            source, _, column = group.placed("f_q", int(system.places["tangent"][g, at]))
            row = np.array(group.record.patterns["f_q"])[:, 0]
            changes = (rounding * np.abs(state.values["tangent"][source]) * size[column]).reshape(group.count, len(row))
            straight = (row % width < system.of_body.linear)[:, None]
            of_rows = changes @ (straight & (row[:, None] == np.arange(width * group.kind.n_bodies)))
            found += zip(group.names, of_rows.max(axis=1).tolist(), strict=True)
    state.evaluate("motion", t)
    forces = state.vector("motion", "f")[system.per_velocity(1.0, 0.0) == 1.0]
    return LostDigits(*max(found, key=lambda each: each[1]), float(np.abs(forces).max(initial=0.0)))


def lost_digits_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """Yield a sentence on the force that rounding changes most at the end of a run, if that is much; the state is changed."""
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
        yield (
            f"the force of '{name}' is known to about {lost:.1g} N only, as are reactions: coordinates have 16 digits, "
            f"and it is so stiff; the largest force is {largest:.3g} N; use a joint, or less stiffness"
        )
