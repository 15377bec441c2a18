"""Changes of forces by the rounding of coordinates: 0.01 N at a coordinate of 1 m for a stiffness of 1e14 N/m."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .state import State
from .terms import TERM_SETS

ROUNDING = 2.0 * np.finfo(float).eps
"""Four roundings, relative to a coordinate."""


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
    at = 1 + TERM_SETS["tangent"].index("f_q")
    for g, group in enumerate(system.groups):
        if group.entries["f_q"] and group.kind.element.kind:
            source, _, column = group.placed("f_q", int(system.places["tangent"][g, at]))
            row = np.array(group.record.patterns["f_q"])[:, 0]
            changes = (ROUNDING * np.abs(state.values["tangent"][source]) * size[column]).reshape(group.count, len(row))
            straight = (row % width < system.of_body.linear)[:, None]
            of_rows = changes @ (straight & (row[:, None] == np.arange(width * group.kind.n_bodies)))
            found += zip(group.names, of_rows.max(axis=1).tolist(), strict=True)
    state.evaluate("motion", t)
    forces = state.vector("motion", "f")[system.per_velocity(1.0, 0.0) == 1.0]
    return LostDigits(*max(found, key=lambda each: each[1]), float(np.abs(forces).max(initial=0.0)))
