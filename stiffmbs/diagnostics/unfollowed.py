"""Where on the way prescribed velocities are not followed any more: the mechanism locks, and there is no motion beyond."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..solve.dynamics import Dynamics
from ..solve.trajectory import Trajectory

UNFOLLOWED_PART, UNFOLLOWED_VELOCITY = 1e-2, 1e-3
"""Violation of a velocity equation, relative to its summands and at least in m/s or rad/s, that no tolerance explains."""
MOST_OUTPUTS = 200
"""Outputs to look at: a mechanism that has locked does not follow its drive afterwards either."""


@dataclass(frozen=True)
class Unfollowed:
    """A velocity equation that does not hold.

    Attributes
    ----------
    output : int
        The first output at which it does not.
    row : int
    gap : float
        What it is off by, m/s or rad/s.
    """

    output: int
    row: int
    gap: float


def unfollowed(dynamics: Dynamics, way: Trajectory) -> Unfollowed | None:
    """The first output at which an equation without a position form does not hold.

    The relaxed formulation lets velocities creep where multipliers grow without bound; equations with a position form cannot
    stay violated so.

    Parameters
    ----------
    dynamics : Dynamics
        Its state is changed.
    way : Trajectory
        As integrated.
    """
    rows = np.flatnonzero(dynamics.system.active & ~dynamics.system.holonomic)
    if not len(rows):
        return None
    last = 0
    for output in np.unique(np.linspace(0, len(way.t) - 1, MOST_OUTPUTS).astype(int)).tolist():
        if _worst(dynamics, rows, way, output):
            return next(found for k in range(last, output + 1) if (found := _worst(dynamics, rows, way, k)))
        last = output
    return None


def _worst(dynamics: Dynamics, rows: np.ndarray, way: Trajectory, output: int) -> Unfollowed | None:
    """Of some equations that which is off most at an output, if by too much."""
    system, state = dynamics.system, dynamics.state
    V, J = system.term("motion", "V"), system.term("motion", "J")
    u = way.u[output]
    state.q[:], state.u[:] = way.q[output], u
    state.evaluate("motion", float(way.t[output]))
    values = state.values["motion"]
    gaps, sizes = np.zeros(system.n_c), np.zeros(system.n_c)
    gaps[V.row] = np.abs(values[V.source])
    np.add.at(sizes, J.row, np.abs(values[J.source] * u[J.column]))
    row = int(rows[np.argmax(gaps[rows] - np.maximum(UNFOLLOWED_PART * sizes[rows], UNFOLLOWED_VELOCITY))])
    wrong = gaps[row] > max(UNFOLLOWED_PART * sizes[row], UNFOLLOWED_VELOCITY)
    return Unfollowed(output, row, float(gaps[row])) if wrong else None
