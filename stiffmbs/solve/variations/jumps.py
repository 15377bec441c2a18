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
from ...compile.equations import Equations
from ...compile.record import source_of
from ...compile.written_values import writer
from ...errors import SolverError
from ..dynamics import Dynamics
from ..failures import FAILURES
from .recorded import Segment
from .saddle import saddle_solution

NO_JUMP = 100.0
"""Times the relative tolerance by which rates may differ on both sides of an instant without counting as a jump."""
MUCH_LARGER = 2.0
"""Times by which positions may change more, seen from an event, for them to be integrated so."""
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


@dataclass(frozen=True)
class Shifted:
    """How a state changes in each direction, seen from an instant that moves: s + y' dt_e/dp.

    Attributes
    ----------
    q, u : ndarrays, shapes (directions, n_q), (directions, n_u)
    shift : ndarray, shape (directions,)
        dt_e/dp.
    """

    q: np.ndarray
    u: np.ndarray
    shift: np.ndarray

    def unshifted(self, q_rates: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How it changes at a fixed instant, given its rates."""
        return self.q - np.outer(self.shift, q_rates), self.u - np.outer(self.shift, acceleration)

    def shifted_where(self, kept: np.ndarray, q_rates: np.ndarray, acceleration: np.ndarray) -> Shifted:
        """The same with the shift of some directions alone."""
        q, u = self.unshifted(q_rates, acceleration)
        rows = kept[:, None]
        return Shifted(np.where(rows, self.q, q), np.where(rows, self.u, u), np.where(kept, self.shift, 0.0))


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
        self._small = NO_JUMP * rtol
        self._events: list[Direction] = []
        self._motions: list[Direction] = []

    def over(self, before: Segment, after: Segment, s: Shifted) -> Shifted:
        """How the state changes behind the start of a segment, given how it changes at the end of the one before."""
        left = self._end(before)
        right = self._start(after, after.first[0] - left.t)
        q, u = s.unshifted(left.q_rates, left.acceleration)
        moved = self._instants(before, left, right, q, u)
        if moved is None:
            moved = np.zeros(len(q))
        to_q, to_u = q + np.outer(moved, left.q_rates), u + np.outer(moved, left.acceleration)
        if self._dynamics.system.n_c:
            to_u = self._projected(left, right.t, to_q, to_u, moved)
        found = Shifted(to_q, to_u, moved)
        nearer = np.abs(to_q).max(axis=1) <= MUCH_LARGER * np.abs(q).max(axis=1)
        return found.shifted_where(nearer & bool(before.fired), right.q_rates, right.acceleration)

    def _instants(
        self, before: Segment, left: _State, right: _State, q: np.ndarray, u: np.ndarray
    ) -> np.ndarray | None:
        """How the instant between two segments moves in each direction; None where it need not be known."""
        jumps = self._counts(left.q_rates - right.q_rates, left.q_rates)
        jumps = jumps or self._counts(left.acceleration - right.acceleration, left.acceleration)
        if not before.fired:
            return self._breakpoint_rates(right.t) if jumps else None
        changes, rates, largest = self._event(before, left, q, u)
        if np.all(np.abs(rates) > GRAZING * max(largest, np.abs(rates).max())):
            return np.asarray(-changes / rates)
        if not jumps:
            return None
        name = writer(self._dynamics.system, "event_function", before.fired[0])
        raise SolverError(
            f"sensitivities: found that '{name}' only grazes its breakpoint at t = {left.t:.9g} s, where the motion is not "
            "differentiable by parameters; expected an event that is passed"
        )

    def _end(self, segment: Segment) -> _State:
        """The end of a segment, by the law that held there: the integrator's own y' has seen what follows."""
        at, n = self._equations.at, self._equations.n
        t, y = segment.rows[-1][0], segment.rows[-1][2 : 2 + n]
        return self._state(t, y[at["q"]], y[at["u"]])

    def _start(self, segment: Segment, ahead: float) -> _State:
        """The start of a segment, by the law that holds from there on: a little ahead, as at the very instant any law may."""
        at = self._state(segment.first[0], segment.start.q, segment.start.u)
        return self._state(at.t + ahead, at.q + ahead * at.q_rates, at.u + ahead * at.acceleration)

    def _state(self, t: float, q: np.ndarray, u: np.ndarray) -> _State:
        dynamics = self._dynamics
        dynamics.state.q[:], dynamics.state.u[:] = q, u
        status, acceleration = dynamics.accelerate(t)
        if status < 0:
            raise SolverError(f"sensitivities: no accelerations were found at t = {t:.9g} s: {FAILURES[status]}")
        rates = dynamics.position_rates(q, u)
        return _State(t, q, u, rates, acceleration, dynamics.state.lam.copy())

    def _event(
        self, segment: Segment, left: _State, q: np.ndarray, u: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """How the event function that has fired changes in each direction, and with time; and the largest of all of them."""
        state = self._dynamics.state
        self._events = self._events or [Direction(state, "event_function", numbers) for numbers in self._numbers]
        state.q[:], state.u[:], state.lam[:] = left.q, left.u, left.lam
        (event, *_), found = segment.fired, []
        self._refuse_reactions(event, left.t)
        for direction, of_q, of_u in zip(self._events, q, u, strict=True):
            direction.q[:], direction.u[:] = of_q, of_u
            direction.evaluate(left.t)
            change = direction.values[event]
            direction.q += left.q_rates
            direction.u += left.acceleration
            direction.evaluate(left.t, 1.0)
            found.append((change, direction.values[event] - change))
        changes, rates = np.array(found).T
        largest = np.abs(state.values["event_function"][: self._dynamics.system.n_event_functions]).max()
        return changes, rates, float(largest)

    def _refuse_reactions(self, event: int, t: float) -> None:
        system = self._dynamics.system
        name = writer(system, "event_function", event)
        group = next(group for group in system.groups if name in group.names)
        if "lam[" in (source_of(group.kind, "event_function") or ""):
            raise SolverError(
                f"sensitivities: found that a breakpoint of '{name}' at t = {t:.9g} s depends on a reaction, expected one that "
                "depends on positions, velocities and time"
            )

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
