"""States along a prescribed motion: their differential equations, integrated between two of its instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import SolverError
from ..algebraic_states import rates_by_states
from ..dynamics import Dynamics

STATE_TOLERANCE = 1e-10
"""Relative tolerance, and absolute one in scales of the states."""
MOST_MOVES = 12
LOOK, TOO_MANY = 5_000, 3e6
"""Evaluations from one look at the pace to the next, and those still to come at which states are given up: ten minutes or more."""


@dataclass(frozen=True)
class Instant:
    """A state of a prescribed motion, and how fast its counters of turns run."""

    t: float
    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    turning: np.ndarray


def states_after(dynamics: Dynamics, before: Instant, t: float) -> np.ndarray:
    """The states at a later instant, shape (states,), the algebraic ones as they were; the state at hand is left as it is.

    Parameters
    ----------
    dynamics : Dynamics
    before : Instant
        From which predictions of the pose lead to every instant up to t.
    t : float
        s.

    Raises
    ------
    SolverError
        Where the states cannot be integrated, or come to no end; SciPy's Radau (Hairer and Wanner II, ch. IV.8) does that.
    """
    system = dynamics.system
    states, changing = before.q[system.first_state :].copy(), ~system.algebraic
    if not changing.any() or t <= before.t:
        return states
    from scipy.integrate import solve_ivp

    along = _Along(dynamics, before, t)
    with dynamics.state.unchanged():
        found = solve_ivp(
            along.rates, (before.t, t), states[changing], method="Radau", jac=along.jacobian,
            rtol=STATE_TOLERANCE, atol=STATE_TOLERANCE * system.state_scales[changing], t_eval=[t],
        )  # fmt: skip
    if not found.success:
        raise SolverError(f"stopped after t = {before.t:.9g} s: the states could not be integrated: {found.message}")
    states[changing] = found.y[:, -1]
    return states


class _Along:
    """Rates of the states at instants of the motion."""

    def __init__(self, dynamics: Dynamics, before: Instant, end: float) -> None:
        self._dynamics, self._before, self._end = dynamics, before, end
        self._evaluations, self._looked_at = 0, before.t
        self._places = dynamics.system.first_state + np.flatnonzero(~dynamics.system.algebraic)

    def rates(self, t: float, values: np.ndarray) -> np.ndarray:
        """x' at an instant.

        Raises
        ------
        SolverError
            Where so many evaluations would follow that they come to no end.
        """
        self._evaluations += 1
        if self._evaluations % LOOK == 0:
            self._look_at_pace(t)
        if not self._go_to(t, values):
            return np.full(len(values), np.nan)
        state = self._dynamics.state
        return self._dynamics.position_rates(state.q, state.u)[self._places]

    def _look_at_pace(self, t: float) -> None:
        way, self._looked_at = t - self._looked_at, t
        if (self._end - t) * LOOK > TOO_MANY * max(way, 0.0):
            raise SolverError(
                f"stopped at t = {t:.9g} s: the states could not be integrated: the last {LOOK} evaluations have covered {way:.3g} s; "
                "expected rates that change less, or fewer digits in what they follow from"
            )

    def jacobian(self, t: float, values: np.ndarray) -> np.ndarray:
        """dx'/dx at an instant."""
        self._go_to(t, values)
        self._dynamics.state.evaluate("tangent", t)
        return rates_by_states(self._dynamics)

    def _go_to(self, t: float, values: np.ndarray) -> bool:
        """Make the state at hand that of the motion at an instant; whether it was found."""
        dynamics, before, system = self._dynamics, self._before, self._dynamics.system
        state, h = dynamics.state, t - before.t
        state.q[:] = system.of_body.moved(before.q, h * before.u + h * h / 2 * before.acceleration)
        state.q[system.n_pose : system.first_state] += h * before.turning
        state.q[self._places] = values
        state.u[:] = before.u + h * before.acceleration
        if dynamics.assemble(t, most=MOST_MOVES) < 0 or dynamics.correct_velocities(t) < 0:
            return False
        return dynamics.accelerate(t)[0] == 0
