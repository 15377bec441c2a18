"""Differential equations of user-defined states along a prescribed motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compile.machine.native.statuses import NOT_FINITE
from ..dynamics.algebraic_states import failure, rates_by_states
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..tuning import tuned
from .events.chattering import CHATTERING
from .explicit.native.parameters import CONTROL


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

    SciPy's Radau is used (Hairer and Wanner II, sec. IV.8). The current state is restored. `before`: state from which
    the poses up to t are predicted. `t`: s. Raises SolverError when the states cannot be integrated, or would require
    too many evaluations.
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
            rtol=KINEMATIC.tolerance, atol=KINEMATIC.tolerance * system.state_scales[changing], t_eval=[t],
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

        Raises SolverError when too many evaluations would remain.
        """
        self._evaluations += 1
        if self._evaluations % CONTROL.enough_steps == 0:
            self._check_mean_step(t)
        if not self._go_to(t, values):
            return np.full(len(values), np.nan)
        state = self._dynamics.state
        return self._dynamics.position_rates(state.q, state.u)[self._places]

    def _check_mean_step(self, t: float) -> None:
        covered, self._looked_at = t - self._looked_at, t
        if (self._end - t) * CONTROL.enough_steps > CHATTERING.too_many * max(covered, 0.0):
            raise SolverError(
                f"stopped at t = {t:.9g} s: the states could not be integrated: the last {CONTROL.enough_steps} evaluations covered only {covered:.3g} s; "
                "expected smoother rates, or inputs with less rounding"
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
        if dynamics.assemble(t) < 0 or dynamics.correct_velocities(t) < 0:
            return False
        return dynamics.accelerate(t)[0] == 0


class IntegratedMotion:
    """Motion determined by position and velocity equations together; it has the methods of `kinematic._Motion`.

    All velocities follow from J u + C_t = 0. SciPy's DOP853 (Hairer, Noersett, Wanner, sec. II.10) integrates q' = Z u
    between output times, where positions are projected onto C = 0. `t`: s. `longest`: longest
    step, s, which resolves the drives.
    """

    def __init__(self, dynamics: Dynamics, start: InitialValues, t: float, longest: float) -> None:
        self._dynamics, self._longest = dynamics, longest
        self.t, self.steps, self.moves = t, 0, 0
        self.q, self.u = start.q, start.u
        dynamics.state.q[:], dynamics.state.u[:] = start.q, start.u
        self._take(t)

    def go_to(self, end: float) -> None:
        """Integrate the motion to a later time.

        Raises SolverError when the drives demand velocities that the mechanism cannot have.
        """
        if end <= self.t:
            return
        from scipy.integrate import solve_ivp

        found: Any = solve_ivp(
            self._rates, (self.t, end), self.q, method="DOP853", rtol=KINEMATIC.tolerance, atol=KINEMATIC.tolerance, t_eval=[end],
            first_step=min(end - self.t, self._longest), max_step=self._longest,
        )  # fmt: skip
        if not found.success:
            raise SolverError(self._stuck(NOT_FINITE))
        self.steps += found.nfev // 12
        self._dynamics.state.q[:] = found.y[:, -1]
        self._take(end)

    def go_past(self, t: float) -> None:
        """Recompute velocities just after a breakpoint."""
        self._dynamics.state.q[:] = self.q + (t - self.t) * self._rates(self.t, self.q)
        self._take(t)

    def _rates(self, t: float, q: np.ndarray) -> np.ndarray:
        """Return q' of the prescribed motion, NaN where it has no solution."""
        state, dynamics = self._dynamics.state, self._dynamics
        state.q[:] = q
        if dynamics.correct_velocities(t) < 0 or dynamics.accelerate(t)[0] != 0:
            return np.full(len(q), np.nan)
        return dynamics.position_rates(state.q, state.u)

    def _take(self, t: float) -> None:
        """Project the current state onto the constraints and accept it."""
        dynamics = self._dynamics
        moves = dynamics.assemble(t)
        status = min(moves, 0) or dynamics.correct_velocities(t)
        if status < 0:
            raise SolverError(self._stuck(status))
        dynamics.assemble(t, tolerance=0.0, most=2)  # to rounding, whether or not it is reached
        dynamics.correct_velocities(t)
        self.t, self.moves = t, self.moves + moves
        self.q, self.u = dynamics.state.q.copy(), dynamics.state.u.copy()

    def _stuck(self, status: int) -> str:
        return f"stopped after t = {self.t:.9g} s: {failure(self._dynamics, status, self.t)}"


@dataclass(frozen=True)
class KinematicParameters:
    """Parameters of the solver kinematic.

    Source: ``tests/solve/test_kinematic.py`` and ``tests/solve/test_spatial_kinematic.py``.
    """

    surprise: float = 0.05
    """Largest distance from predicted to corrected positions, as a fraction of the step's displacement."""
    change: float = 0.5
    """Largest distance from predicted to corrected velocities, as a fraction of their norm."""
    tolerance: float = 1e-11
    """Relative tolerance of integrated positions and user-defined states, and absolute one, m, rad and in the scales of
    states."""


KINEMATIC = tuned("kinematic", KinematicParameters())
