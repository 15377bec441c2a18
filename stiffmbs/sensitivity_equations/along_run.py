"""Sensitivities along a recorded run, segment by segment, with jumps at breakpoints and events."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..compile.directional.direction import Numbers
from ..compile.equations import ABSENT
from ..dynamics.dynamics import Dynamics, OutputRows
from .block_system import BlockSystem, Change
from .collocation import CollocationVariations
from .equations import VariationalEquations, singular
from .jumps import BreakpointRates, Jump, Jumps, Shifted, State
from .recorded import Recorder, Segment
from .touches import Touches


@dataclass(frozen=True)
class Side:
    """Side of a breakpoint or an event at an output time; `values` are those of output terms, shape (directions, values)."""

    row: OutputRows
    change: Change
    values: np.ndarray


@dataclass(frozen=True)
class Instant:
    """Sensitivities at an output time.

    Attributes
    ----------
    number : int
        Number of the output time.
    change, values
        As in `Side`.
    sides : tuple of Side
        Both sides of a parameter-dependent breakpoint or event at this time, else empty.
    moved : ndarray of bool, shape (directions,)
        True for the directions in which it moves.
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
        self._dynamics, self._recorder = dynamics, recorder
        self._equations = recorder.equations
        self.block = BlockSystem(dynamics, directions)
        kind = CollocationVariations if len(recorder.nodes) else VariationalEquations
        self._variations = kind(recorder.equations, recorder.native.matrix, dynamics.state, directions)
        self._jumps = Jumps(
            dynamics, recorder.equations, directions, self.block, breakpoint_rates, recorder.settings.rtol
        )

    def at(self, rows: OutputRows, wanted: np.ndarray, start_q: np.ndarray, start_u: np.ndarray) -> Iterator[Instant]:
        """Yield the sensitivities at selected output times.

        Parameters
        ----------
        wanted : ndarray of int
            Numbers of the output times, increasing.
        start_q, start_u : ndarrays, shapes (directions, n_q), (directions, n_u)
            Sensitivities of the initial state.
        """
        s, asked = Shifted(start_q, start_u, np.zeros(len(start_q))), list(wanted)
        segments = self._recorder.passed(rows.t[-1] - rows.t[0])
        Touches(self._recorder).refuse(segments)
        while asked and rows.t[asked[0]] <= segments[0].first[0]:
            yield self._instant(rows, asked.pop(0), s)
        for segment, following in zip(segments, [*segments[1:], None], strict=True):
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
                yield self._instant(rows, k, self._parts(at_instant, s.shift))
            if not asked or following is None:
                return
            self._variations.advance(self._steps(segment, done, len(segment.rows)))
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
        rates[:, at["u"]] = -defects[:, at["u"]] / self._dynamics.system.mass
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
