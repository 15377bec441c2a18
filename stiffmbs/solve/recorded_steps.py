"""Accepted steps of `bdf` and `radau`, recorded in memory for the error estimate after a run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..compile.equations import Equations

if TYPE_CHECKING:
    from .trajectory import Recording


@dataclass(frozen=True, eq=False)
class Piece:
    """Steps between two starts of the integrator; row 0 is the start, the others are points of the steps in order of time.

    - `t` of shape (rows,), `q`, `u` of shapes (rows, n_q), (rows, n_u).
    - `points`: rows per step; all but the last are within the step.
    - `fired`: event functions that ended the piece; empty at a breakpoint in time, a change of order or the end of the run.
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    points: int
    fired: tuple[int, ...]


@dataclass
class _Open:
    """Rows of a piece so far: time, order, y and y'."""

    rows: list[np.ndarray]
    fired: tuple[int, ...] = ()


@dataclass
class StepRecorder:
    """Steps of one run.

    - `bounds`: largest work of the estimate of errors, and the work of a row and of a restart. Beyond the largest work
      nothing is kept and `full` is True.
    - `points`: rows per step.
    - `of_a_row`: work of the estimate for a row.
    """

    bounds: Recording
    points: int = 1
    of_a_row: float = 1.0
    full: bool = False
    _pieces: list[_Open] = field(default_factory=list)
    _work: float = 0.0
    _events: int = 0

    def begin(self, row: np.ndarray) -> None:
        """Start a piece with the row of a start."""
        if not self.full:
            after_event = bool(self._pieces and self._pieces[-1].fired)
            self._events += after_event
            self._pieces.append(_Open([row[None]]))
            self._count(0.0 if after_event and self._events <= self.bounds.events else self.bounds.restart)

    def extend(self, rows: np.ndarray, fired: tuple[int, ...]) -> None:
        """Append the rows of steps, after which event functions fired."""
        self._count(len(rows) * self.of_a_row)
        if self._pieces:
            if len(rows):
                self._pieces[-1].rows.append(rows)
            self._pieces[-1].fired = fired

    def _count(self, work: float) -> None:
        """Add to the work of the estimate; keep nothing if it exceeds the largest one."""
        self._work += work
        if self._work > self.bounds.most:
            self.full = True
            self._pieces.clear()

    def pieces(self, equations: Equations) -> tuple[Piece, ...]:
        """Return the pieces of nonzero length, in all coordinates of the system."""
        made = (self._piece(each, equations) for each in self._pieces)
        return tuple(piece for piece in made if len(piece.t) > self.points)

    def _piece(self, piece: _Open, equations: Equations) -> Piece:
        rows, n = np.concatenate(piece.rows), equations.n
        t, keep = rows[:, 0], np.ones(len(rows), dtype=bool)
        ends = np.arange(self.points, len(rows), self.points)
        short = ends[np.diff(t[np.append(0, ends)]) <= 0.0]  # a second call at the same time
        for k in range(self.points):
            keep[short - k] = False
        rows = rows[keep]
        q, u = equations.states(rows[:, 2 : 2 + n][:, equations.independent])
        return Piece(rows[:, 0].copy(), q.copy(), u.copy(), self.points, piece.fired)
