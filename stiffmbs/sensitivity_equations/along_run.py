"""Sensitivities along a recorded run, segment by segment, with jumps at breakpoints and events."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..compile.directional.direction import Direction, Numbers, unchanged
from ..compile.directional.source import STATE
from ..compile.equations import ABSENT
from ..compile.written_values import writer
from ..dynamics.dynamics import Dynamics, OutputRows
from ..errors import SolverError
from ..solve.error_control.tolerances import independent_tolerances
from .block_system import BlockSystem, Change
from .collocation import CollocationVariations
from .equations import VariationalEquations, singular
from .jumps import BreakpointRates, Jump, Jumps, Shifted, State
from .recorded import SENSITIVITIES, Recorder, Segment


@dataclass(frozen=True)
class Side:
    """Side of a breakpoint or an event at an output time; `values` are those of output terms, shape (directions, values)."""

    row: OutputRows
    change: Change
    values: np.ndarray


@dataclass(frozen=True)
class Instant:
    """Sensitivities at an output time.

    - `number`: number of the output time.
    - `change`, `values`: as in `Side`.
    - `sides`: both sides of a parameter-dependent breakpoint or event at this time, else empty.
    - `moved` of shape (directions,): true for the directions in which it moves.
    """

    number: int
    change: Change
    values: np.ndarray
    sides: tuple[Side, ...] = ()
    moved: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))


class AlongRun:
    """Sensitivities of a run that has been recorded."""

    def __init__(
        self, dynamics: Dynamics, recorder: Recorder, directions: Sequence[Numbers], breakpoint_rates: BreakpointRates
    ) -> None:
        self._dynamics, self._recorder, self._directions = dynamics, recorder, directions
        self._equations = recorder.equations
        self.block = BlockSystem(dynamics, directions)
        kind = CollocationVariations if len(recorder.nodes) else VariationalEquations
        self._variations = kind(recorder.equations, recorder.engine.matrix, dynamics.state, directions)
        self._jumps = Jumps(
            dynamics, recorder.equations, directions, self.block, breakpoint_rates, recorder.settings.rtol
        )

    def at(self, rows: OutputRows, wanted: np.ndarray, start_q: np.ndarray, start_u: np.ndarray) -> Iterator[Instant]:
        """Yield the sensitivities at selected output times.

        `wanted`: numbers of the output times, increasing. `start_q`, `start_u` of shapes (directions, n_q),
        (directions, n_u): sensitivities of the initial state.
        """
        s, asked = Shifted(start_q, start_u, np.zeros(len(start_q))), list(wanted)
        segments = self._recorder.passed(rows.t[-1] - rows.t[0])
        touches = Touches(self._recorder, self._directions)
        resting = touches.refuse(segments)
        while asked and rows.t[asked[0]] <= segments[0].first[0]:
            yield self._instant(rows, asked.pop(0), s)
        for segment, following, at_rest in zip(segments, [*segments[1:], None], resting, strict=True):
            self._begin(segment, s)
            end = segment.rows[-1, 0] if following else np.inf
            done = 0
            while asked and rows.t[asked[0]] < end:
                k = asked.pop(0)
                step = int(np.searchsorted(segment.rows[:, 0], rows.t[k], side="left"))
                step = min(max(done, step), len(segment.rows) - 1)
                self._variations.advance(self._steps(segment, done, step))
                done = step
                following_step = self._steps(segment, step, step + 1)[0]
                at_instant = self._variations.within(self._rows(rows.at(np.array([k])))[0], following_step)
                touches.refuse_rest(at_rest, segment, at_instant)
                yield self._instant(rows, k, self._parts(at_instant, s.shift))
            if not asked or following is None:
                return
            self._variations.advance(self._steps(segment, done, len(segment.rows)))
            touches.refuse_rest(at_rest, segment, self._variations.last)
            jump = self._jumps.over(segment, following, self._parts(self._variations.last, s.shift))
            while asked and rows.t[asked[0]] <= following.first[0]:
                yield self._between(rows, asked.pop(0), jump)
            s = jump.s

    def _parts(self, s: np.ndarray, shift: np.ndarray) -> Shifted:
        """Split sensitivities into those of q and u."""
        return Shifted(s[:, self._equations.at["q"]], s[:, self._equations.at["u"]], shift)

    def _instant(self, rows: OutputRows, k: int, s: Shifted) -> Instant:
        """Return the sensitivities of the state at an output time."""
        t, q, u = rows.t[k], rows.q[k], rows.u[k]
        moved_q, moved_u = s.q, s.u
        if s.shift.any():
            self._dynamics.state.q[:], self._dynamics.state.u[:] = q, u
            _, acceleration = self._dynamics.accelerate(t)
            moved_q, moved_u = s.unshifted(self._dynamics.position_rates(q, u), acceleration)
        return Instant(k, *self._changes(t, q, u, moved_q, moved_u))

    def _between(self, rows: OutputRows, k: int, jump: Jump) -> Instant:
        """Return the sensitivities at an output time that coincides with a breakpoint or an event."""
        found = self._instant(rows, k, jump.s)
        if not jump.moved.any():
            return found
        sides = (self._side(jump.left, *jump.q_u_left), self._side(jump.right, *jump.q_u_right))
        return replace(found, sides=sides, moved=jump.moved != 0.0)

    def _side(self, at: State, moved_q: np.ndarray, moved_u: np.ndarray) -> Side:
        row = self._dynamics.report(np.array([at.t]), at.q[None].copy(), at.u[None].copy(), False)
        return Side(row, *self._changes(at.t, at.q, at.u, moved_q, moved_u))

    def _changes(
        self, t: float, q: np.ndarray, u: np.ndarray, moved_q: np.ndarray, moved_u: np.ndarray
    ) -> tuple[Change, np.ndarray]:
        """Return the sensitivities of a state and its output terms."""
        change = self.block.change(t, q, u, moved_q, moved_u, np.zeros(len(moved_q)))
        return change, self.block.outputs(t, change)

    def _begin(self, segment: Segment, given: Shifted) -> None:
        """Start the variational equations at the start of a segment."""
        at, first = self._equations.at, segment.first
        change = self.block.change(first[0], segment.start.q, segment.start.u, given.q, given.u, given.shift)
        s = np.zeros((len(change.q), self._equations.n))
        s[:, at["q"]], s[:, at["u"]] = change.q, change.u
        solved = at["lam"] != ABSENT
        s[:, at["lam"][solved]] = change.lam[:, solved]
        self._variations.shift(given.shift)
        defects, rates = self._variations.defects(first, s), np.zeros_like(s)
        rates[:, at["q"]] = -defects[:, at["q"]]
        rates[:, at["u"]] = change.acceleration
        self._variations.begin(first[0], segment.rows[0, 0] - first[0], s, rates)

    def _rows(self, rows: OutputRows) -> np.ndarray:
        """Return rows of the recorded form for output times."""
        at, n = self._equations.at, self._equations.n
        y, yp = np.zeros((2, len(rows.t), n))
        y[:, at["q"]], y[:, at["u"]], yp[:, at["u"]] = rows.q, rows.u, rows.acceleration
        solved = at["lam"] != ABSENT
        y[:, at["lam"][solved]] = rows.lam[:, solved]
        return np.column_stack([rows.t, np.zeros(len(rows.t)), y, yp])

    def _steps(self, segment: Segment, begin: int, end: int) -> np.ndarray:
        """Return some steps of a segment, with accelerations and multipliers at the places within them."""
        steps = segment.steps[begin:end]
        if not segment.places or not len(steps):
            return steps
        within = steps[:, :-1].reshape(-1, steps.shape[2])
        y = within[:, 2 : 2 + self._equations.n]
        q, u = self._equations.states(np.ascontiguousarray(y[:, self._equations.independent]))
        rows = self._dynamics.report(np.ascontiguousarray(within[:, 0]), q, u, False)
        if len(rows.t) < len(within):
            raise singular(within[len(rows.t), 0])
        found = steps.copy()
        found[:, :-1] = self._rows(rows).reshape(found[:, :-1].shape)
        return found

    def close(self) -> None:
        """Free the objects of SUNDIALS."""
        self._variations.close()


FORCES = "f", "rate"
"""Terms of the equations of motion with forces, and of the rates of states."""


class Touches:
    """Detector of events that graze a breakpoint, or rest on it, in a recorded run with some directions of change."""

    def __init__(self, recorder: Recorder, directions: Sequence[Numbers]) -> None:
        self._directions = directions
        self._recorder, self._dynamics = recorder, recorder.dynamics
        self._count = self._dynamics.system.n_event_functions
        self._atol = np.zeros(recorder.equations.n)
        self._atol[recorder.equations.independent] = independent_tolerances(recorder.equations, recorder.settings)
        self._by_time = Direction(self._dynamics.state, "event_function", unchanged(self._dynamics.system), STATE)

    def refuse(self, segments: Sequence[Segment]) -> list[np.ndarray]:
        """Return the event functions that are on their breakpoints throughout each segment.

        Raise a SolverError if a discontinuous force almost reaches, or barely crosses, its breakpoint.
        """
        if not self._count:
            return [np.empty(0, dtype=int)] * len(segments)
        rows = np.concatenate([part for each in segments for part in (each.first[None], each.rows)])
        found = np.array([self._values(row) for row in rows])
        g, rates = found[:, 0], found[:, 1]
        steps = np.diff(rows[:, 0])
        turns = (rates[:-1] * rates[1:] < 0) & (steps > 0)[:, None]
        near = np.minimum(np.abs(g[:-1]), np.abs(g[1:])) <= SENSITIVITIES.near * np.abs(g).max(axis=0)
        for k, event in np.argwhere(turns & near):
            part = rates[k, event] / (rates[k, event] - rates[k + 1, event])
            y = self._between(rows[k], rows[k + 1], part)
            t = rows[k, 0] + part * steps[k]
            if self._turns(rows[k], (t, y), rows[k + 1], event) and self._touched(t, y, event, len(rows)):
                name = writer(self._dynamics.system, "event_function", int(event))
                raise SolverError(
                    f"sensitivities: found that '{name}' grazes its breakpoint at t = {t:.9g} s, within the integration error, where "
                    "the motion is not differentiable with respect to parameters; expected an event that crosses it or stays clear of it"
                )

        ends = np.cumsum([1 + len(each.rows) for each in segments])
        return [np.flatnonzero(np.abs(part).max(axis=0) <= SENSITIVITIES.at_rest) for part in np.split(g, ends[:-1])]

    def refuse_rest(self, resting: np.ndarray, segment: Segment, s: np.ndarray) -> None:
        """Raise a SolverError if a parameter moves the state off a breakpoint that it rests on, with other forces on each side.

        `s` of shape (directions, n): sensitivities of the recorded state.
        """
        if not len(resting):
            return
        n, row = self._recorder.equations.n, segment.rows[-1]
        t, y, least = row[0], row[2 : 2 + n], SENSITIVITIES.noticed * (1.0 + np.abs(row[2 + n :]).max())
        for numbers, dy in zip(self._directions, s, strict=True):
            size = SENSITIVITIES.moved / max(float(np.abs(dy).max()), 1.0)
            whole, half = (self._bend(t, y, dy, numbers, part * size) for part in (1.0, 0.5))
            errors = [self._off_differences(t, y, dy, numbers, part * size) for part in (1.0, 0.5)]
            if np.any((half > SENSITIVITIES.kinked * whole) & (whole > least)):
                reason = (
                    "and that a parameter moves it off: the motion is not differentiable there; expected an event that crosses "
                    "it or stays clear of it"
                )
            elif np.any((errors[1] > SENSITIVITIES.steady * errors[0]) & (size * errors[0] > least)):
                reason = (
                    "where the derivatives of its formula are those of neither side; expected one smooth formula instead of "
                    "several with breakpoints that cancel"
                )
            else:
                continue
            name = writer(self._dynamics.system, "event_function", int(resting[0]))
            raise SolverError(
                f"sensitivities: found that '{name}' stays on its breakpoint from t = {segment.first[0]:.9g} s to {t:.9g} s, {reason}"
            )

    def _off_differences(self, t: float, y: np.ndarray, dy: np.ndarray, numbers: Numbers, size: float) -> np.ndarray:
        """Return the error of the derivatives of forces along a change of state and numbers, beyond rounding of differences."""
        before, after = (self._with_numbers(t, y, dy, numbers, part, self._forces) for part in (-size, size))
        self._recorder.take(y, self._dynamics.state)
        direction = Direction(self._dynamics.state, "motion", numbers)
        self._recorder.take(dy, direction)
        direction.evaluate(t)
        found = np.concatenate([direction.vector(name) for name in FORCES])
        system, values = self._dynamics.system, self._dynamics.state.values["motion"]
        terms = np.concatenate([system.term("motion", name).source for name in FORCES])
        largest, of_values = (float(np.max(np.abs(each[terms]), initial=0.0)) for each in (values, direction.values))
        rounding = SENSITIVITIES.rounded * (largest / size + of_values * (1.0 + np.abs(y).max()) / SENSITIVITIES.moved)
        return np.maximum(np.abs(found - (after - before) / (2 * size)) - rounding, 0.0)

    def _forces(self, t: float, y: np.ndarray) -> np.ndarray:
        self._recorder.take(y, self._dynamics.state)
        self._dynamics.state.evaluate("motion", t)
        return np.concatenate([self._dynamics.state.vector("motion", name) for name in FORCES])

    def _bend(self, t: float, y: np.ndarray, dy: np.ndarray, numbers: Numbers, size: float) -> np.ndarray:
        """Return the second difference of the rates along a change of state and numbers."""
        found = [self._with_numbers(t, y, dy, numbers, part, self._rates) for part in (-size, 0.0, size)]
        return np.asarray(np.abs(found[0] - 2 * found[1] + found[2]))

    def _with_numbers(
        self, t: float, y: np.ndarray, dy: np.ndarray, numbers: Numbers, part: float,
        evaluated: Callable[[float, np.ndarray], np.ndarray],
    ) -> np.ndarray:  # fmt: skip
        """Return a function of the state after a part of a change of state and numbers."""
        groups = self._dynamics.system.groups
        kept = {g: groups[g].numbers.copy() for g in numbers.moved}
        try:
            for g, own in kept.items():
                groups[g].numbers[:] = own + part * numbers.of_groups[g]
            return evaluated(t, y + part * dy)
        finally:
            for g, own in kept.items():
                groups[g].numbers[:] = own

    def _values(self, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the event functions and their rates at a recorded state."""
        n, rates = self._recorder.equations.n, self._by_time
        self._recorder.take(row[2 : 2 + n], self._dynamics.state)
        self._recorder.take(row[2 + n :], rates)
        rates.evaluate(row[0], 1.0)
        values = self._dynamics.state.values["event_function"]
        return values[: self._count].copy(), rates.values[: self._count].copy()

    def _between(self, before: np.ndarray, after: np.ndarray, part: float) -> np.ndarray:
        """Return the state within a step, by cubic Hermite interpolation."""
        n, h = self._recorder.equations.n, after[0] - before[0]
        (y, yp), (z, zp) = ((row[2 : 2 + n], row[2 + n :]) for row in (before, after))
        s = part
        return np.asarray(
            (1 + 2 * s) * (1 - s) ** 2 * y
            + s * (1 - s) ** 2 * h * yp
            + s * s * (3 - 2 * s) * z
            + s * s * (s - 1) * h * zp
        )

    def _turns(self, before: np.ndarray, at: tuple[float, np.ndarray], after: np.ndarray, event: int) -> bool:
        """Return True if an event function of the motion turns: in short steps, recorded reactions and their rates are not those of the motion."""
        n = self._recorder.equations.n
        g = [
            self._consistent(t, y, event) for t, y in ((before[0], before[2 : 2 + n]), at, (after[0], after[2 : 2 + n]))
        ]
        return (g[1] - g[0]) * (g[2] - g[1]) < 0

    def _touched(self, t: float, y: np.ndarray, event: int, steps: int) -> bool:
        """Return True if an event function is zero within the integration error, and rates are discontinuous there."""
        tolerance = steps * (self._recorder.settings.rtol * np.abs(y) + self._atol)
        slope = self._slope(t, y, event, tolerance)
        margin = float(np.abs(slope) @ tolerance)
        here = self._value(t, y, event)
        if not abs(here) <= margin:
            return False
        dy = np.sign(slope) * tolerance / margin
        near, far = (self._change(t, y, dy, -here, size) for size in (2 * margin, 2 * SENSITIVITIES.further * margin))
        return bool(np.any((near > SENSITIVITIES.linear * far) & (near > 0)))

    def _slope(self, t: float, y: np.ndarray, event: int, moves: np.ndarray) -> np.ndarray:
        """Return the derivatives of an event function with respect to the state, by differences over the tolerances."""
        slope, at = np.zeros(len(y)), self._recorder.equations.independent
        for k in at[moves[at] > 0]:
            moved = np.zeros(len(y))
            moved[k] = moves[k]
            slope[k] = (self._value(t, y + moved, event) - self._value(t, y - moved, event)) / (2 * moves[k])
        return slope

    def _value(self, t: float, y: np.ndarray, event: int) -> float:
        self._recorder.take(y, self._dynamics.state)
        self._dynamics.state.evaluate("event_function", t)
        return float(self._dynamics.state.values["event_function"][event])

    def _consistent(self, t: float, y: np.ndarray, event: int) -> float:
        """Return an event function with the reactions and algebraic states of the motion."""
        self._recorder.take(y, self._dynamics.state)
        self._dynamics.accelerate(t)
        self._dynamics.state.evaluate("event_function", t)
        return float(self._dynamics.state.values["event_function"][event])

    def _change(self, t: float, y: np.ndarray, dy: np.ndarray, to_zero: float, size: float) -> np.ndarray:
        """Return the difference between the rates on both sides of the breakpoint."""
        one, other = (self._rates(t, y + (to_zero + side * size) * dy) for side in (-1, 1))
        return np.asarray(np.abs(other - one))

    def _rates(self, t: float, y: np.ndarray) -> np.ndarray:
        self._recorder.take(y, self._dynamics.state)
        _, acceleration = self._dynamics.accelerate(t)
        q_rates = self._dynamics.position_rates(self._dynamics.state.q, self._dynamics.state.u)
        return np.concatenate([acceleration, q_rates[self._dynamics.system.first_state :]])
