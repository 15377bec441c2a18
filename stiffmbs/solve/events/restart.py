"""Restart within a run, at a breakpoint or an event."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...compile.state import LEFT_OPEN
from ...dynamics.algebraic_states import failure
from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...errors import SolverError
from ...tuning import tuned
from ..suspect import most_violated


@dataclass(frozen=True)
class RestartParameters:
    """Parameters of the extrapolation after an event."""

    hidden: float = 1e-11
    """Interval, relative to the time, in which rounding may hide a sign change of an event function, as at an
    extremum."""
    passed: float = 1e-2
    """Fraction of the last step, times rtol, by which the motion is extrapolated."""
    largest_rtol: float = 1e-4
    """Upper bound of that rtol."""


RESTARTS = tuned("restarts", RestartParameters())


def straight_on(t: float, step: float, rtol: float) -> float:
    """Return the time, s, of extrapolation after an event at t; at least the interval that rounding may hide."""
    return max(RESTARTS.passed * min(rtol, RESTARTS.largest_rtol) * step, RESTARTS.hidden * abs(t))


def restarted(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, project: bool = True) -> InitialValues:
    """Return consistent values near given ones, with new accelerations and multipliers.

    `t`: s. `q`, `u` of shapes (n_q,), (n_u,). `project`: if True, q and u are first projected onto the constraints.
    Raises SolverError if the constraints cannot be satisfied or are dependent, or if accelerations are not determined.
    """
    state = dynamics.state
    state.q[:], state.u[:] = q, u
    if project and dynamics.system.n_c:
        status = dynamics.assemble(t)
        _go_on(dynamics, status, t, "" if status >= 0 else _no_longer_redundant(dynamics, t, q))
        _go_on(dynamics, dynamics.correct_velocities(t), t)
    state.restart_counters(t)
    status, acceleration = dynamics.accelerate(t)
    _go_on(dynamics, status, t)
    return InitialValues(state.q.copy(), state.u.copy(), acceleration, state.lam.copy(), (), dynamics.system.size)


def _go_on(dynamics: Dynamics, status: int, t: float, clause: str = "") -> None:
    if status < 0:
        raise SolverError(
            f"no consistent values were found for a restart at t = {t:.9g} s: {failure(dynamics, status, t)}{clause}"
        )


def _no_longer_redundant(dynamics: Dynamics, t: float, q: np.ndarray) -> str:
    """Return a clause on the omitted redundant equation with the largest violation; empty if all hold."""
    system = dynamics.system
    dynamics.state.q[:] = q
    gap, joint, equation = most_violated(dynamics, t, ~system.active & system.holonomic)
    if not gap > LEFT_OPEN * min(1.0, system.size):
        return ""
    return (
        f"; joint '{joint}' (equation {equation}), left out because it is redundant near the start, is violated there"
    )
