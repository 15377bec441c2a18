"""Jumps of sensitivities where the run starts anew: at breakpoints of inputs, and at events.

Where the law changes at an instant t_e that itself changes with a parameter, q and u just behind it change by
    q_+ = q_- + (q'_- - q'_+) dt_e/dp,    u_+ = (u_- + u'_- dt_e/dp, brought to the constraints) - u'_+ dt_e/dp
(Galan, Feehery and Barton, Appl. Numer. Math. 31, 1999), with dt_e/dp = -(g_q q_- + g_u u_- + g_p)/g' for an event function g.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...compile.directional.direction import Direction, Numbers
from ...compile.equations import ABSENT, Equations
from ...errors import SolverError
from ..dynamics import Dynamics
from ..failures import FAILURES
from .recorded import Segment
from .saddle import saddle_solution

SMALL = 100.0
"""Times the relative tolerance by which rates may differ on both sides of an instant without counting as a jump."""
GRAZING = 1e-9
"""Part of an event function's change in the segment, over its time, below which its rate counts as zero."""


@dataclass(frozen=True)
class _State:
    """One side of an instant: q, u, and their rates."""

    t: float
    q: np.ndarray
    u: np.ndarray
    q_rates: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray


class Jumps:
    """What sensitivities jump by between two segments of a run.

    Parameters
    ----------
    dynamics : Dynamics
    equations : Equations
        Of the run.
    directions : sequence of Numbers
    breakpoint_rates : callable
        How a breakpoint at some time moves in each direction.
    rtol : float
        Of the run.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        equations: Equations,
        directions: Sequence[Numbers],
        breakpoint_rates: Callable[[float], np.ndarray],
        rtol: float,
    ) -> None:
        self._dynamics, self._equations = dynamics, equations
        self._numbers, self._breakpoint_rates = directions, breakpoint_rates
        self._small = SMALL * rtol
        self._events: list[Direction] = []
        self._motions: list[Direction] = []

    def over(self, before: Segment, after: Segment, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How q and u change behind the start of a segment.

        Parameters
        ----------
        before, after : Segment
        s : ndarray, shape (directions, n)
            How the unknowns change at the end of the first.

        Returns
        -------
        ndarrays, shapes (directions, n_q), (directions, n_u)
        """
        at = self._equations.at
        q, u = s[:, at["q"]], s[:, at["u"]]
        left, right = self._end(before), self._start(after)
        jump_q, jump_u = left.q_rates - right.q_rates, left.acceleration - right.acceleration
        moved = np.zeros(len(s))
        if self._counts(jump_q, left.q_rates) or self._counts(jump_u, left.acceleration):
            moved = self._event_rates(before, left, s) if before.fired else self._breakpoint_rates(right.t)
        towards = u + np.outer(moved, left.acceleration)
        if self._dynamics.system.n_c:
            towards = self._projected(left, right.t, q + np.outer(moved, left.q_rates), towards, moved)
        return q + np.outer(moved, jump_q), towards - np.outer(moved, right.acceleration)

    def _end(self, segment: Segment) -> _State:
        """The end of a segment, by the law that held there: the integrator's own y' has seen what follows."""
        at, n = self._equations.at, self._equations.n
        t, y = segment.rows[-1][0], segment.rows[-1][2 : 2 + n]
        return self._state(t, y[at["q"]], y[at["u"]])

    def _start(self, segment: Segment) -> _State:
        return self._state(segment.first[0], segment.start.q, segment.start.u)

    def _state(self, t: float, q: np.ndarray, u: np.ndarray) -> _State:
        dynamics = self._dynamics
        dynamics.state.q[:], dynamics.state.u[:] = q, u
        status, acceleration = dynamics.accelerate(t)
        if status < 0:
            raise SolverError(f"sensitivities: no accelerations were found at t = {t:.9g} s: {FAILURES[status]}")
        rates = dynamics.position_rates(q, u)
        return _State(t, q, u, rates, acceleration, dynamics.state.lam.copy())

    def _event_rates(self, segment: Segment, left: _State, s: np.ndarray) -> np.ndarray:
        """How the instant of an event moves in each direction: -g_p/g' by all that g hangs on."""
        at, state = self._equations.at, self._dynamics.state
        self._events = self._events or [Direction(state, "event_function", numbers) for numbers in self._numbers]
        state.q[:], state.u[:], state.lam[:] = left.q, left.u, left.lam
        (event, *_), found = segment.fired, []
        for direction, moved in zip(self._events, s, strict=True):
            direction.q[:], direction.u[:] = moved[at["q"]], moved[at["u"]]
            direction.lam[:] = np.where(at["lam"] == ABSENT, 0.0, moved[at["lam"]])
            direction.evaluate(left.t)
            at_once = direction.values[event]
            direction.q += left.q_rates
            direction.u += left.acceleration
            direction.evaluate(left.t, 1.0)
            found.append((at_once, direction.values[event] - at_once))
        changes, rates = np.array(found).T
        largest = np.abs(state.values["event_function"][: self._dynamics.system.n_event_functions]).max()
        if not np.all(np.abs(rates) > GRAZING * max(largest, np.abs(rates).max())):
            name = self._dynamics.system.writer("event_function", event)
            raise SolverError(
                f"sensitivities: found that '{name}' only grazes its breakpoint at t = {left.t:.9g} s, where the motion is not "
                "differentiable by parameters; expected an event that is passed"
            )
        return -changes / rates

    def _projected(
        self, left: _State, t: float, q: np.ndarray, u: np.ndarray, moved: np.ndarray
    ) -> np.ndarray:  # fmt: skip
        """How velocities change once they are brought to the constraints by the smallest correction in the mass matrix."""
        state, system = self._dynamics.state, self._dynamics.system
        self._motions = self._motions or [Direction(state, "motion", numbers) for numbers in self._numbers]
        state.q[:], state.u[:] = left.q, left.u
        state.evaluate("motion", t)
        right = np.concatenate([np.zeros(system.n_u), -state.vector("motion", "V")])
        correction, w = np.split(saddle_solution(state, "motion", right[:, None])[:, 0], [system.n_u])
        columns = []
        for direction, of_q, of_u, of_t in zip(self._motions, q, u, moved, strict=True):
            direction.q[:], direction.u[:] = of_q, of_u
            direction.evaluate(t, of_t)
            force = -direction.numbers.mass * correction - direction.product("J", w, True)
            columns.append(np.concatenate([force, -direction.vector("V") - direction.product("J", correction)]))
        solved = saddle_solution(state, "motion", np.array(columns).T)
        return u + solved[: system.n_u].T

    def _counts(self, jump: np.ndarray, rates: np.ndarray) -> bool:
        """Whether rates jump by more than integration leaves them off by."""
        return bool(np.abs(jump).max(initial=0.0) > self._small * np.abs(rates).max(initial=0.0))
