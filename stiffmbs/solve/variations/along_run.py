"""Sensitivities along a recorded run: from start to start, with the jumps that breakpoints and events make between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ...compile.directional.direction import Numbers
from ...compile.equations import ABSENT
from ..dynamics import Dynamics, OutputRows
from .block_system import BlockSystem, Change
from .equations import VariationalEquations
from .jumps import Jumps, Shifted
from .recorded import Recorder, Segment

BreakpointRates = Callable[[float], np.ndarray]
"""How a breakpoint at some time, s, moves in each direction, shape (directions,)."""


class AlongRun:
    """The sensitivities of a run.

    Parameters
    ----------
    dynamics : Dynamics
    recorder : Recorder
        After its run.
    directions : sequence of Numbers
    breakpoint_rates : callable
    """

    def __init__(
        self, dynamics: Dynamics, recorder: Recorder, directions: Sequence[Numbers], breakpoint_rates: BreakpointRates
    ) -> None:
        self._dynamics, self._recorder = dynamics, recorder
        self._equations = recorder.equations
        self.block = BlockSystem(dynamics, directions)
        self._variations = VariationalEquations(recorder.equations, recorder.native.matrix, dynamics.state, directions)
        self._jumps = Jumps(dynamics, recorder.equations, directions, breakpoint_rates, recorder.settings.rtol)

    def at(
        self, rows: OutputRows, wanted: np.ndarray, start_q: np.ndarray, start_u: np.ndarray
    ) -> Iterator[tuple[int, Change]]:
        """How the state changes at some of the output instants.

        Parameters
        ----------
        rows : OutputRows
            Of the run.
        wanted : ndarray of int
            The numbers of instants, increasing.
        start_q, start_u : ndarrays, shapes (directions, n_q), (directions, n_u)
            How the start changes.

        Yields
        ------
        (int, Change)
            The state of the dynamics is then that of the instant.
        """
        s, asked = Shifted(start_q, start_u, np.zeros(len(start_q))), list(wanted)
        segments = [segment for segment in self._recorder.segments if len(segment.rows)]
        for segment, following in zip(segments, [*segments[1:], None], strict=True):
            while asked and rows.t[asked[0]] <= segment.first[0]:
                yield asked[0], self._change(rows, asked.pop(0), s)
            self._begin(segment, s)
            end = following.first[0] if following else np.inf
            done = 0
            while asked and rows.t[asked[0]] < end:
                k = asked.pop(0)
                step = int(np.searchsorted(segment.rows[:, 0], rows.t[k], side="left"))
                step = min(max(done, step), len(segment.rows) - 1)
                self._variations.advance(segment.rows[done:step])
                done = step
                at_instant = self._variations.within(self._row(rows, k, segment.rows[step, 1]))
                yield k, self._change(rows, k, self._parts(at_instant, s.shift))
            if not asked or following is None:
                return
            self._variations.advance(segment.rows[done:])
            s = self._jumps.over(segment, following, self._parts(self._variations.last, s.shift))

    def _parts(self, s: np.ndarray, shift: np.ndarray) -> Shifted:
        """Of q and u."""
        return Shifted(s[:, self._equations.at["q"]], s[:, self._equations.at["u"]], shift)

    def _change(self, rows: OutputRows, k: int, s: Shifted) -> Change:
        """How the state of an output instant changes."""
        t, q, u = rows.t[k], rows.q[k], rows.u[k]
        moved_q, moved_u = s.q, s.u
        if s.shift.any():
            self._dynamics.state.q[:], self._dynamics.state.u[:] = q, u
            _, acceleration = self._dynamics.accelerate(t)
            moved_q, moved_u = s.unshifted(self._dynamics.position_rates(q, u), acceleration)
        return self.block.change(t, q, u, moved_q, moved_u, np.zeros(len(s.shift)))

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

    def _row(self, rows: OutputRows, k: int, order: float) -> np.ndarray:
        """A row of the form of recorded ones for an output instant."""
        at, n = self._equations.at, self._equations.n
        y, yp = np.zeros(n), np.zeros(n)
        y[at["q"]], y[at["u"]], yp[at["u"]] = rows.q[k], rows.u[k], rows.acceleration[k]
        solved = at["lam"] != ABSENT
        y[at["lam"][solved]] = rows.lam[k][solved]
        return np.concatenate([[rows.t[k], order], y, yp])

    def close(self) -> None:
        """Free what SUNDIALS holds."""
        self._variations.close()
