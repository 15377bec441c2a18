"""Starting anew in the middle of a run, at a breakpoint or an event."""

from __future__ import annotations

import numpy as np

from ...compile.state import LEFT_OPEN
from ...errors import SolverError
from ..algebraic_states import failure
from ..dynamics import Dynamics
from ..initial import InitialValues

INDISTINCT = 4 * float(np.finfo(float).eps)
"""Part of a time within which another one is taken for the same, by IDA and for breakpoints, which rounding moves by as much."""


def just_before(t: float) -> float:
    """The first instant that counts as t."""
    return t - INDISTINCT * abs(t)


def just_after(t: float) -> float:
    """The last instant that counts as t: IDA refuses to start towards one that is nearer than two roundings."""
    return t + INDISTINCT * abs(t)


def restarted(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, project: bool = True) -> InitialValues:
    """Consistent values near given ones: projected onto the constraints, with new accelerations and multipliers.

    Parameters
    ----------
    t : float
        s.
    q, u : ndarrays, shapes (n_q,), (n_u,)
    project : bool
        Whether q and u are first brought back to the constraints.

    Raises
    ------
    SolverError
        When the constraints cannot be satisfied or are dependent there, or accelerations are not determined.
    """
    state = dynamics.state
    state.q[:], state.u[:] = q, u
    if project and dynamics.system.n_c:
        status = dynamics.assemble(t)
        _go_on(dynamics, status, t, "" if status >= 0 else _no_longer_redundant(dynamics, t, q))
        _go_on(dynamics, dynamics.correct_velocities(t), t)
    state.count_anew(t)
    status, acceleration = dynamics.accelerate(t)
    _go_on(dynamics, status, t)
    return InitialValues(state.q.copy(), state.u.copy(), acceleration, state.lam.copy(), ())


def _go_on(dynamics: Dynamics, status: int, t: float, clause: str = "") -> None:
    if status < 0:
        raise SolverError(
            f"no consistent values were found to start anew at t = {t:.9g} s: {failure(dynamics, status, t)}{clause}"
        )


def _no_longer_redundant(dynamics: Dynamics, t: float, q: np.ndarray) -> str:
    """A clause on the equation left out as redundant that is furthest from holding; empty where all hold."""
    system, state = dynamics.system, dynamics.state
    state.q[:] = q
    state.evaluate("position", t)
    gaps = np.abs(state.vector("position", "C")) * (~system.active & system.holonomic)
    row = int(np.argmax(gaps))
    if not gaps[row] > LEFT_OPEN * min(1.0, system.size):
        return ""
    joint, equation = system.equations[row]
    return f"; joint '{joint}' (equation {equation}) was left out, as near the start it holds the same as others; it does not hold there"
