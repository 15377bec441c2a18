"""Kinematic analysis with drives that prescribe velocities, which are integrated over time."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.machine.native.statuses import NOT_FINITE
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from .kinematic_parameters import KINEMATIC


class IntegratedMotion:
    """Motion determined by position and velocity equations together; it has the methods of `kinematic._Motion`.

    All velocities follow from J u + C_t = 0. SciPy's DOP853 (Hairer, Noersett, Wanner, sec. II.10) integrates q' = Z u
    between output times, where positions are projected onto C = 0.

    Parameters
    ----------
    dynamics : Dynamics
    start : InitialValues
    t, shortest : float
        s; no state is computed within `shortest` of a breakpoint.
    longest : float
        Longest step, s, which resolves the drives.
    """

    def __init__(self, dynamics: Dynamics, start: InitialValues, t: float, shortest: float, longest: float) -> None:
        self._dynamics, self._shortest, self._longest = dynamics, shortest, longest
        self.t, self.steps, self.moves = t, 0, 0
        self.q, self.u = start.q, start.u
        dynamics.state.q[:], dynamics.state.u[:] = start.q, start.u
        self._take(t)

    def go_to(self, end: float) -> None:
        """Integrate the motion to a later time.

        Raises
        ------
        SolverError
            When the drives demand velocities that the mechanism cannot have.
        """
        if end <= self.t:
            return
        from scipy.integrate import solve_ivp

        found: Any = solve_ivp(
            self._rates, (self.t, end), self.q, method="DOP853", rtol=KINEMATIC.place_tolerance, atol=KINEMATIC.place_tolerance, t_eval=[end],
            first_step=min(end - self.t, self._longest) / 8, max_step=self._longest,
        )  # fmt: skip
        if not found.success:
            raise SolverError(self._stuck(NOT_FINITE))
        self.steps += found.nfev // 12
        self._dynamics.state.q[:] = found.y[:, -1]
        self._take(end)

    def go_past(self, breakpoint: float) -> None:
        """Integrate to a breakpoint, then recompute velocities on its far side."""
        self.go_to(breakpoint - self._shortest)
        self._dynamics.state.q[:] = self.q + 2 * self._shortest * self._rates(self.t, self.q)
        self._take(breakpoint + self._shortest)

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
        moves = dynamics.assemble(t, most=KINEMATIC.most_moves)
        status = min(moves, 0) or dynamics.correct_velocities(t)
        if status < 0:
            raise SolverError(self._stuck(status))
        dynamics.assemble(t, tolerance=0.0, most=2)  # to rounding, whether or not it is reached
        dynamics.correct_velocities(t)
        self.t, self.moves = t, self.moves + moves
        self.q, self.u = dynamics.state.q.copy(), dynamics.state.u.copy()

    def _stuck(self, status: int) -> str:
        return f"stopped after t = {self.t:.9g} s: {failure(self._dynamics, status, self.t)}"
