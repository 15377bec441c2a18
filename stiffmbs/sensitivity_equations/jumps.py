"""Jumps of sensitivities at restarts: at input breakpoints and at events.

If a force law changes at a time t_e that depends on a parameter, the sensitivities of q and u just after it are

    q_+ = q_- + (q'_- - q'_+) dt_e/dp,    u_+ = (u_- + u'_- dt_e/dp, projected) - u'_+ dt_e/dp

(Galan, Feehery and Barton, Appl. Numer. Math. 31, 1999), with dt_e/dp = -(g_q q_- + g_u u_- + g_p)/g' for an event
function g. The projection is that onto the constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.directional.direction import Direction, Numbers, unchanged
from ..compile.directional.source import STATE
from ..compile.equations import Equations
from ..compile.written_values import writer
from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from .block_system import BlockSystem, acceleration_at, saddle_solution
from .recorded import SENSITIVITIES, Segment

BreakpointRates = Callable[[float, bool], np.ndarray | None]
"""Function of a time, s, and a flag that requires a result.

It returns the derivatives of the breakpoint at that time, shape (directions,), or None if there is no breakpoint.
"""


@dataclass(frozen=True)
class State:
    """State on one side of an event: q, u and their rates."""

    t: float
    q: np.ndarray
    u: np.ndarray
    q_rates: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray


@dataclass(frozen=True)
class Shifted:
    """Sensitivities of a state at a moving event: s + y' dt_e/dp, one row for each direction, and the `shift` dt_e/dp."""

    q: np.ndarray
    u: np.ndarray
    shift: np.ndarray

    def unshifted(self, q_rates: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the sensitivities at a fixed time, given the rates of the state."""
        return self.q - np.outer(self.shift, q_rates), self.u - np.outer(self.shift, acceleration)

    def shifted_where(self, kept: np.ndarray, q_rates: np.ndarray, acceleration: np.ndarray) -> Shifted:
        """Remove the shift of the directions that are not `kept`."""
        q, u = self.unshifted(q_rates, acceleration)
        rows = kept[:, None]
        return Shifted(np.where(rows, self.q, q), np.where(rows, self.u, u), np.where(kept, self.shift, 0.0))


@dataclass(frozen=True)
class Jump:
    """Event between two segments.

    `q_u_left`, `q_u_right` of shapes (directions, n_q), (directions, n_u): derivatives of both states at a fixed time.
    `moved` of shape (directions,): dt_e/dp. `s`: derivatives of the state after it.
    """

    left: State
    right: State
    q_u_left: tuple[np.ndarray, np.ndarray]
    q_u_right: tuple[np.ndarray, np.ndarray]
    moved: np.ndarray
    s: Shifted


def _matters(left: State, right: State, duration: float) -> bool:
    """Return True if the discontinuity of rates, over the duration of a segment, exceeds rounding in the state."""
    jumps = np.abs(right.q_rates - left.q_rates), np.abs(right.acceleration - left.acceleration)
    return any(
        bool(np.max(jump, initial=0.0) * duration > SENSITIVITIES.alike * np.max(np.abs(size), initial=0.0))
        for jump, size in zip(jumps, (left.q, left.u), strict=True)
    )


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    """Return True if the derivatives of two event times agree in all directions."""
    return bool(np.all(np.abs(one - other) <= SENSITIVITIES.alike * np.maximum(np.abs(one), np.abs(other))))


class Jumps:
    """Jumps of the sensitivities, in some directions, between two segments of a run with the tolerance `rtol`."""

    def __init__(
        self,
        dynamics: Dynamics,
        equations: Equations,
        directions: Sequence[Numbers],
        block: BlockSystem,
        breakpoint_rates: BreakpointRates,
        rtol: float,
    ) -> None:
        self._dynamics, self._equations, self._block = dynamics, equations, block
        self._numbers, self._breakpoint_rates = directions, breakpoint_rates
        self._small = SENSITIVITIES.no_jump * rtol
        self._events: list[Direction] = []
        self._motions: list[Direction] = []

    def over(self, before: Segment, after: Segment, s: Shifted) -> Jump:
        """Return the sensitivities at the start of a segment from those at the end of the previous one."""
        left = self._end(before)
        right = self._start(after, after.first[0] - left.t)
        q, u = s.unshifted(left.q_rates, left.acceleration)
        moved = self._instants(before, left, right, q, u)
        to_q, to_u = q + np.outer(moved, left.q_rates), u + np.outer(moved, left.acceleration)
        if self._dynamics.system.n_c:
            to_u = self._projected(left, right.t, to_q, to_u, moved)
        found = Shifted(to_q, to_u, moved)
        nearer = np.abs(to_q).max(axis=1) <= SENSITIVITIES.much_larger * np.abs(q).max(axis=1)
        there = found.shifted_where(nearer & bool(before.fired), right.q_rates, right.acceleration)
        return Jump(left, right, (q, u), found.unshifted(right.q_rates, right.acceleration), moved, there)

    def _instants(self, before: Segment, left: State, right: State, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return the derivatives of the event time; zero if undetermined without discontinuous rates."""
        jumps = self._counts(left.q_rates - right.q_rates, left.q_rates)
        jumps = jumps or self._counts(left.acceleration - right.acceleration, left.acceleration)
        by_input = self._breakpoint_rates(right.t, jumps and not before.fired)
        moves = {} if by_input is None else {"an input": by_input}
        if before.fired or (self._dynamics.system.n_event_functions and jumps):
            moves = self._moves_of_events(before, left, right, q, u, jumps) | moves
        if jumps and _matters(left, right, left.t - before.first[0]):
            self._refuse_apart(moves, left.t)
        return next(iter(moves.values()), np.zeros(len(q)))

    def _moves_of_events(
        self, before: Segment, left: State, right: State, q: np.ndarray, u: np.ndarray, jumps: bool
    ) -> dict[str, np.ndarray]:
        """Return the derivatives of the event times between two states by element, starting with the located event."""
        changes, rates, values = self._event(left, q, u)
        state, system = self._dynamics.state, self._dynamics.system
        state.q[:], state.u[:], state.lam[:] = right.q, right.u, right.lam
        state.evaluate("event_function", right.t)
        passed = values * state.values["event_function"][: len(values)] < 0
        still = np.abs(rates) <= SENSITIVITIES.grazing * np.maximum(np.abs(values).max(), np.abs(rates))
        if before.fired and still[before.fired[0]]:
            if jumps:
                name = writer(system, "event_function", before.fired[0])
                raise SolverError(
                    f"sensitivities: found that '{name}' grazes its breakpoint at t = {left.t:.9g} s, where the motion is not "
                    "differentiable with respect to parameters; expected an event that crosses it"
                )
            return {}
        events = [*before.fired[:1], *np.flatnonzero(passed & ~still)]
        names = [f"'{writer(system, 'event_function', int(event))}'" for event in events]
        found: dict[str, np.ndarray] = {}
        for name, event in zip(names, events, strict=True):
            moved = -changes[:, event] / rates[event]
            found.setdefault(name if name not in found or _same(found[name], moved) else f"{name} again", moved)
        return found

    @staticmethod
    def _refuse_apart(moves: dict[str, np.ndarray], t: float) -> None:
        """Refuse simultaneous events that parameters separate, as their discontinuities cannot be distinguished."""
        (first, *others), (moved, *rest) = list(moves) or [""], list(moves.values()) or [np.zeros(0)]
        for name, other in zip(others, rest, strict=True):
            if not _same(moved, other):
                raise SolverError(
                    f"sensitivities: found that {first} and {name} have simultaneous events at t = {t:.9g} s, which the "
                    "parameters separate; expected events at different times"
                )

    def _end(self, segment: Segment) -> State:
        """Return the end of a segment with rates of the force law in it, unlike the integrator's own y'."""
        at, n = self._equations.at, self._equations.n
        t, y = segment.rows[-1][0], segment.rows[-1][2 : 2 + n]
        return self._state(t, y[at["q"]], y[at["u"]])

    def _start(self, segment: Segment, ahead: float) -> State:
        """Return the start of a segment with rates of the force law after it, at a time slightly after an event."""
        at, system = self._state(segment.first[0], segment.start.q, segment.start.u), self._dynamics.system
        q_rates = at.q_rates.copy()
        algebraic = system.algebraic_coordinates
        if len(algebraic):
            q_rates[algebraic] = self._block.motion(at.t, at.q, at.u, at.q_rates, at.acceleration).q[0, algebraic]
        return self._state(at.t + ahead, at.q + ahead * q_rates, at.u + ahead * at.acceleration)

    def _state(self, t: float, q: np.ndarray, u: np.ndarray) -> State:
        acceleration = acceleration_at(self._dynamics, t, q, u)
        return State(t, q, u, self._dynamics.position_rates(q, u), acceleration, self._dynamics.state.lam.copy())

    def _event(self, left: State, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return derivatives of event functions, shape (directions, n), their time derivatives, and their values."""
        state, system = self._dynamics.state, self._dynamics.system
        if not self._events:
            by_time = Direction(state, "event_function", unchanged(system), STATE)
            self._events = [*(Direction(state, "event_function", numbers) for numbers in self._numbers), by_time]
        parts = (
            self._block.change(left.t, left.q, left.u, q, u, np.zeros(len(q))),
            self._block.motion(left.t, left.q, left.u, left.q_rates, left.acceleration),
        )
        found, n = [], system.n_event_functions
        moves = [np.concatenate(pair) for pair in zip(*((p.q, p.u, p.acceleration, p.lam) for p in parts), strict=True)]
        for k, direction in enumerate(self._events):
            direction.q[:], direction.u[:], direction.a[:], direction.lam[:] = (move[k] for move in moves)
            direction.evaluate(left.t, float(k == len(q)))
            found.append(direction.values[:n].copy())
        return np.array(found[:-1]), found[-1], state.values["event_function"][:n].copy()

    def _projected(
        self, left: State, t: float, q: np.ndarray, u: np.ndarray, moved: np.ndarray
    ) -> np.ndarray:  # fmt: skip
        """Return the velocity sensitivities after projection onto the constraints in the mass metric."""
        state, system = self._dynamics.state, self._dynamics.system
        self._motions = self._motions or [Direction(state, "motion", numbers) for numbers in self._numbers]
        state.q[:], state.u[:] = left.q, left.u
        state.evaluate("motion", t)
        right = np.concatenate([np.zeros(system.n_u), -state.vector("motion", "V")])
        correction, w = np.split(saddle_solution(state, right[:, None])[:, 0], [system.n_u])
        columns = []
        for direction, of_q, of_u, of_t in zip(self._motions, q, u, moved, strict=True):
            direction.q[:], direction.u[:] = of_q, of_u
            direction.evaluate(t, of_t)
            force = -direction.numbers.mass * correction - direction.product("inertia", correction)
            force -= direction.product("J", w, True)
            columns.append(np.concatenate([force, -direction.vector("V") - direction.product("J", correction)]))
        solved = saddle_solution(state, np.array(columns).T)
        return u + solved[: system.n_u].T

    def _counts(self, jump: np.ndarray, rates: np.ndarray) -> bool:
        """Return True if rates jump by more than the integration error."""
        return bool(np.abs(jump).max(initial=0.0) > self._small * np.abs(rates).max(initial=0.0))
