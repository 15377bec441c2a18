"""Detection of prescribed velocities that are not attained: the mechanism locks, and no motion exists beyond."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..solve.dynamics import Dynamics
from ..solve.trajectory import Trajectory

UNFOLLOWED_PART, UNFOLLOWED_VELOCITY = 1e-2, 1e-3
"""Violation of a velocity equation that no tolerance explains: relative to its terms, and in m/s or rad/s at least."""
MOST_OUTPUTS = 200
"""Number of checked outputs; a mechanism that has locked violates its drive at later outputs too."""


@dataclass(frozen=True)
class Unfollowed:
    """Velocity equation that does not hold.

    Attributes
    ----------
    output : int
        First output at which it does not hold.
    row : int
    gap : float
        Violation, m/s or rad/s.
    """

    output: int
    row: int
    gap: float


def unfollowed(dynamics: Dynamics, way: Trajectory) -> Unfollowed | None:
    """Return the violation at the first output at which a nonholonomic equation does not hold, or None.

    The relaxed formulation lets velocities drift if multipliers grow without bound. Holonomic equations cannot remain
    violated in this way.

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
    outputs = np.unique(np.linspace(0, len(way.t) - 1, MOST_OUTPUTS).astype(int))
    seen = _first(dynamics, rows, way, outputs)
    if seen is None:
        return None
    before = outputs[max(int(np.searchsorted(outputs, seen.output)) - 1, 0)]
    return _first(dynamics, rows, way, np.arange(before, seen.output + 1))


def _first(dynamics: Dynamics, rows: np.ndarray, way: Trajectory, outputs: np.ndarray) -> Unfollowed | None:
    """Return the largest violation of some equations at the first of some outputs at which one is too large."""
    system, state = dynamics.system, dynamics.state
    V, J = system.term("motion", "V"), system.term("motion", "J")
    used = np.isin(J.row, rows)
    row, column, source = J.row[used], J.column[used], J.source[used]
    violations, coefficients = np.empty((len(outputs), len(V.source))), np.empty((len(outputs), len(source)))
    for k, output in enumerate(outputs.tolist()):
        state.q[:], state.u[:] = way.q[output], way.u[output]
        state.evaluate("motion", float(way.t[output]))
        values = state.values["motion"]
        violations[k], coefficients[k] = values[V.source], values[source]
    gaps, sizes = np.zeros((2, len(outputs), system.n_c))
    gaps[:, V.row] = np.abs(violations)
    np.add.at(sizes.T, row, np.abs(coefficients * way.u[outputs][:, column]).T)
    excess = (gaps - np.maximum(UNFOLLOWED_PART * sizes, UNFOLLOWED_VELOCITY))[:, rows]
    wrong = np.flatnonzero(np.any(excess > 0, axis=1))
    if not len(wrong):
        return None
    k = int(wrong[0])
    worst = int(rows[np.argmax(excess[k])])
    return Unfollowed(int(outputs[k]), worst, float(gaps[k, worst]))
