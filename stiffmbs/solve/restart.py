"""Starting anew in the middle of a run, at a corner or an event."""

from __future__ import annotations

import numpy as np

from ..errors import SolverError
from .initial import InitialValues
from .mechanics import Mechanics


def restarted(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray) -> InitialValues:
    """Consistent values near given ones: projected onto the constraints, with new accelerations and multipliers.

    Raises
    ------
    SolverError
        When the constraints cannot be satisfied or are dependent there.
    """
    state = mechanics.state
    state.q[:], state.u[:] = q, u
    if mechanics.assemble(t) < 0 or mechanics.correct_velocities(t) < 0:
        raise SolverError(f"no consistent values were found to start anew at t = {t:.9g} s")
    status, acceleration = mechanics.accelerate(t)
    if status < 0:
        raise SolverError(f"no accelerations were found to start anew at t = {t:.9g} s")
    return InitialValues(state.q.copy(), state.u.copy(), acceleration, state.lam.copy(), ())
