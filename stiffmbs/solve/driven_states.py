"""Differential equations of user-defined states along a prescribed motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..dynamics.algebraic_states import rates_by_states
from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from .kinematic_parameters import KINEMATIC


@dataclass(frozen=True)
class Instant:
    """State of a prescribed motion, with the rates of its rotation counters."""

    t: float
    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    turning: np.ndarray


def states_after(dynamics: Dynamics, before: Instant, t: float) -> np.ndarray:
    """Integrate the states to a later time; return them, shape (states,), with algebraic ones unchanged.

    SciPy's Radau is used (Hairer and Wanner II, sec. IV.8). The current state is restored.

    Parameters
    ----------
    dynamics : Dynamics
    before : Instant
        State from which the poses up to t are predicted.
    t : float
        s.

    Raises
    ------
    SolverError
        When the states cannot be integrated, or would require too many evaluations.
    """
    system = dynamics.system
    states, changing = before.q[system.first_state :].copy(), ~system.without_rate
    if not changing.any() or t <= before.t:
        return states
    from scipy.integrate import solve_ivp

    along = _Along(dynamics, before, t)
    with dynamics.state.unchanged():
        found = solve_ivp(
            along.rates, (before.t, t), states[changing], method="Radau", jac=along.jacobian,
            rtol=KINEMATIC.state_tolerance, atol=KINEMATIC.state_tolerance * system.state_scales[changing], t_eval=[t],
        )  # fmt: skip
    if not found.success:
        raise SolverError(f"stopped after t = {before.t:.9g} s: the states could not be integrated: {found.message}")
    states[changing] = found.y[:, -1]
    return states


class _Along:
    """Rates of the states along the motion."""

    def __init__(self, dynamics: Dynamics, before: Instant, end: float) -> None:
        self._dynamics, self._before, self._end = dynamics, before, end
        self._evaluations, self._looked_at = 0, before.t
        self._places = dynamics.system.first_state + np.flatnonzero(~dynamics.system.without_rate)

    def rates(self, t: float, values: np.ndarray) -> np.ndarray:
        """Return x' at a time, NaN where the motion has no solution.

        Raises
        ------
        SolverError
            When too many evaluations would remain.
        """
        self._evaluations += 1
        if self._evaluations % KINEMATIC.evaluations == 0:
            self._look_at_pace(t)
        if not self._go_to(t, values):
            return np.full(len(values), np.nan)
        state = self._dynamics.state
        return self._dynamics.position_rates(state.q, state.u)[self._places]

    def _look_at_pace(self, t: float) -> None:
        way, self._looked_at = t - self._looked_at, t
        if (self._end - t) * KINEMATIC.evaluations > KINEMATIC.too_many * max(way, 0.0):
            raise SolverError(
                f"stopped at t = {t:.9g} s: the states could not be integrated: the last {KINEMATIC.evaluations} evaluations have covered {way:.3g} s; "
                "expected rates that change less, or fewer digits in what they follow from"
            )

    def jacobian(self, t: float, values: np.ndarray) -> np.ndarray:
        """Return dx'/dx at a time."""
        self._go_to(t, values)
        self._dynamics.state.evaluate("tangent", t)
        return rates_by_states(self._dynamics)

    def _go_to(self, t: float, values: np.ndarray) -> bool:
        """Set the current state to that of the motion at a time; return True if it exists."""
        dynamics, before, system = self._dynamics, self._before, self._dynamics.system
        state, h = dynamics.state, t - before.t
        state.q[:] = system.of_body.moved(before.q, h * before.u + h * h / 2 * before.acceleration)
        state.q[system.n_pose : system.first_state] += h * before.turning
        state.q[self._places] = values
        state.u[:] = before.u + h * before.acceleration
        if dynamics.assemble(t, most=KINEMATIC.most_moves) < 0 or dynamics.correct_velocities(t) < 0:
            return False
        return dynamics.accelerate(t)[0] == 0
