"""Fastest rate of a motion, for the stability limit of explicit integrators."""

from __future__ import annotations

import numpy as np

from ...dynamics.algebraic_states import rates_by_states
from ...dynamics.dynamics import Dynamics
from .memory import FASTEST_RATE


def fastest_rate(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> float:
    """Return a lower bound of the largest |lambda|, 1/s, of the motion about a state on the constraints.

    It costs about as much as a step of order 8.
    """
    state, eliminated = dynamics.state, dynamics.eliminated
    state.q[:], state.u[:] = q, u
    work = np.empty(3 * dynamics.system.n_u + dynamics.system.n_q)
    addresses = (dynamics.system.mass, work, eliminated.table, dynamics.table)
    rate = FASTEST_RATE.call(t, eliminated.serves, *(array.ctypes.data for array in addresses))
    dynamics.forget_pivots()
    return max(float(rate), _of_states(dynamics, t, q, u))


def _of_states(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> float:
    """Return the largest |lambda| of the user-defined states at a fixed motion, 1/s."""
    system, state = dynamics.system, dynamics.state
    if not system.states:
        return 0.0
    state.q[:], state.u[:] = q, u
    state.evaluate("tangent", t)
    own = rates_by_states(dynamics)
    return float(np.abs(np.linalg.eigvals(own)).max(initial=0.0)) if np.all(np.isfinite(own)) else 0.0
