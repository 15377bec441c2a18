"""Starting anew in the middle of a run, at a breakpoint or an event."""

from __future__ import annotations

import numpy as np

from ...compile.machine.layout import addresses
from ...compile.machine.routines import Routine
from ...compile.state import LEFT_OPEN
from ...errors import SolverError
from ..algebraic_states import failure
from ..dynamics import Dynamics
from ..initial import InitialValues

GONE_PAST = Routine(
    "stiffmbs.solve.native.event_search.past",
    "gone_past",
    "float64(float64, float64, int64, float64*, float64*, int64*)",
)
INDISTINCT = 4 * float(np.finfo(float).eps)
"""Part of a time within which another one is taken for the same, by IDA and for breakpoints, which rounding moves by as much."""


HIDDEN = 1e-11
"""Interval, relative to the time, in which rounding may hide a change of an event function: 10^5 roundings, as near the maximum of a
sine."""
PASSED, LARGEST_RTOL = 1e-2, 1e-4
"""How far the motion goes straight on behind an event: part of the last step, times the relative tolerance or this at most.  What a
law changes in that time is so much below the tolerance."""


def just_before(t: float) -> float:
    """The first instant that counts as t."""
    return t - INDISTINCT * abs(t)


def just_after(t: float) -> float:
    """The last instant that counts as t: IDA refuses to start towards one that is nearer than two roundings."""
    return t + INDISTINCT * abs(t)


def straight_on(t: float, step: float, rtol: float) -> float:
    """Return the time, s, for which the motion after an event at t is extrapolated, at least the interval that rounding may hide."""
    return max(PASSED * min(rtol, LARGEST_RTOL) * step, HIDDEN * abs(t))


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
    _take(dynamics, t, q, u, project)
    return _at_hand(dynamics, t)


def restarted_past(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, ahead: float
) -> tuple[InitialValues, float]:
    """Consistent values behind an event, at its time or a little ahead, and the time that they belong to.

    On the constraints the state may be before the event again, and another event function may change at the same instant: each
    would be one more event.  Where an event function changes on the straight way ahead, the motion starts anew behind it.

    Parameters
    ----------
    t : float
        s.
    q, u : ndarrays, shapes (n_q,), (n_u,)
    ahead : float
        Length of the straight way, s (`straight_on`); 0 for none.
    """
    _take(dynamics, t, q, u)
    if ahead:
        t += _gone_past(dynamics, t, ahead)
    return _at_hand(dynamics, t), t


def _gone_past(dynamics: Dynamics, t: float, ahead: float) -> float:
    """Move the state at hand on at its velocities where event functions change on that way; for how long."""
    count = dynamics.system.n_event_functions
    dynamics.state.load("event_function")
    memory = np.empty(len(dynamics.state.q)), np.empty(count)  # held as long as compiled code works on it
    return float(GONE_PAST.short_call(t, ahead, count, *addresses(*memory, dynamics.table)))


def _take(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, project: bool = True) -> None:
    """The state given, brought back to the constraints."""
    state = dynamics.state
    state.q[:], state.u[:] = q, u
    if project and dynamics.system.n_c:
        status = dynamics.assemble(t)
        _go_on(dynamics, status, t, "" if status >= 0 else _no_longer_redundant(dynamics, t, q))
        _go_on(dynamics, dynamics.correct_velocities(t), t)


def _at_hand(dynamics: Dynamics, t: float) -> InitialValues:
    """The state at hand with its accelerations and multipliers."""
    state = dynamics.state
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
