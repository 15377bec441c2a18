"""Detection of prescribed velocities that are not attained: the mechanism locks, and no motion exists beyond."""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..solve.trajectory import Trajectory
from .instants import some_instants

UNFOLLOWED_PART, UNFOLLOWED_VELOCITY = 1e-2, 1e-3
"""Violation of a velocity equation that no tolerance explains: relative to its terms, and in m/s or rad/s at least."""


Unfollowed = tuple[int, int, float]
"""First output at which a velocity equation does not hold, its row, and the violation, m/s or rad/s."""


def unfollowed(dynamics: Dynamics, way: Trajectory) -> Unfollowed | None:
    """Return the violation at the first output at which a nonholonomic equation does not hold, or None.

    The relaxed formulation lets velocities drift if multipliers grow without bound. Holonomic equations cannot remain
    violated in this way. The state of `dynamics` is changed.
    """
    rows = np.flatnonzero(dynamics.system.active & ~dynamics.system.holonomic)
    if not len(rows):
        return None
    outputs = some_instants(len(way.t))  # a mechanism that has locked violates its drive at later outputs too
    seen = _first(dynamics, rows, way, outputs)
    if seen is None:
        return None
    before = outputs[max(int(np.searchsorted(outputs, seen[0])) - 1, 0)]
    return _first(dynamics, rows, way, np.arange(before, seen[0] + 1))


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
    return int(outputs[k]), worst, float(gaps[k, worst])
