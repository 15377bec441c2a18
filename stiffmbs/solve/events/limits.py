"""Where the law of a force ends to hold, as beyond the turns that a spring can tell: the run stops there, and says so."""

from __future__ import annotations

import numpy as np

from ...compile.written_values import beyond
from ...errors import SolverError
from ..dynamics import Dynamics


def refuse_beyond_limits(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> None:
    """Stop a run whose state has passed the limits of a force.

    Raises
    ------
    SolverError
        Names the element.
    """
    system, state = dynamics.system, dynamics.state
    first, end = system.first_limit, system.n_event_functions
    if first == end:
        return
    state.q[:], state.u[:] = q, u
    state.evaluate("event_function", t)
    passed = np.flatnonzero(state.values["event_function"][first:end] <= 0)
    if len(passed):
        raise SolverError(f"stopped at t = {t:.9g} s: {beyond(system, first + int(passed[0]))}")
