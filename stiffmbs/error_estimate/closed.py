"""Errors that satisfy their equation at each node, not only in blocks of steps and to first order.

An error e of a pose stretches a stiff spring by e^2 times its curvature: 1e-10 m at 1e-5 rad are 100 N at 1e12 N/m. Matrices by
differences, and means of defects over steps, do not balance such forces either. Newton's iteration on e' = F(z) - F(z - e) + d,
with e' of the transport, does so in the directions that are stiff within a step.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.native.parameters import CONSISTENCY
from .coordinates import displaced
from .evaluated import Evaluated, evaluated
from .linearised import Linearised, linearised, rate_changes
from .parameters import ESTIMATE
from .restarts import motion

Closed: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Positions and velocities, one state per row, and a mask of those whose stiff forces say nothing."""


def closed(
    dynamics: Dynamics, at: Evaluated, space: Linearised, errors: np.ndarray, slopes: np.ndarray, step: float
) -> Closed:
    """Return q and u of states without their errors (dq, du, ds), closed onto the equations where that is possible, and where not.

    `slopes`: e' - d at the states, NaN where they are unknown. `step`: longest step, s; as in a stiff projection, the matrix of a
    part of it separates the directions that are stiff.
    """
    (q, u), open_ = displaced(dynamics.system, at.q, at.u, -errors), np.zeros(len(errors), dtype=bool)
    known = np.flatnonzero(np.isfinite(slopes).all(axis=1))
    if not space.n or not len(known):
        return q, u, open_
    rows, space = np.arange(len(known)), space.at(known)
    iteration = _Iteration(dynamics, at.at(known), space, errors[known], slopes[known], CONSISTENCY.step_parts / step)
    iteration.take(rows, space)
    rows = iteration.open(rows)
    while len(rows):
        sizes = iteration.sizes[rows]
        iteration.take(rows, linearised(dynamics, iteration.states(rows), step))
        rows = iteration.open(rows[iteration.sizes[rows] < CONSISTENCY.restored * sizes])
    q[known], u[known], open_[known] = iteration.q, iteration.u, iteration.fails
    return q, u, open_


class _Iteration:
    """Newton's iteration of many states; `q`, `u` and `sizes` are the states with the least residuals so far, and these."""

    def __init__(
        self, dynamics: Dynamics, at: Evaluated, space: Linearised, errors: np.ndarray, slopes: np.ndarray, cj: float
    ) -> None:
        self._dynamics, self._at, self._left, self._cj = dynamics, at, space.left, cj
        self._errors, self._slopes = errors, slopes
        everywhere = np.arange(len(errors))
        there, self._residuals, self.sizes = self._looked_at(everywhere, errors, slopes)
        self.q, self.u = there.q.copy(), there.u.copy()
        of_errors, of_motion = (self._size(everywhere, each) for each in (slopes, motion(dynamics.system, at)))
        self._much = np.maximum(of_errors, ESTIMATE.large * of_motion)
        self._enough = np.maximum(ESTIMATE.large * of_errors, ESTIMATE.difference * of_motion)

    @property
    def fails(self) -> np.ndarray:
        """Return a mask of the states with residuals as large as the rates of their errors, and visible in those of the motion."""
        return self.sizes > self._much

    def open(self, rows: np.ndarray) -> np.ndarray:
        """Return those of some rows whose residuals are still large."""
        return rows[self.sizes[rows] > self._enough[rows]]

    def states(self, rows: np.ndarray) -> Evaluated:
        """Return the states of some rows."""
        return evaluated(self._dynamics, self._at.t[rows], self.q[rows], self.u[rows])

    def take(self, rows: np.ndarray, space: Linearised) -> None:
        """Iterate with the matrices of some rows while that brings them nearer to the equations."""
        matrices = space.left @ (self._cj * space.basis - space.rates)
        errors, slopes, residuals = self._errors[rows], self._slopes[rows], self._residuals[rows]
        last, going = [np.full(len(rows), np.inf), self.sizes[rows]], np.arange(len(rows))
        going = going[self.sizes[rows] > self._enough[rows]]
        while len(going):
            change = np.linalg.solve(matrices[going], space.left[going] @ residuals[going, :, None])
            change = -(space.basis[going] @ change)[..., 0]
            errors[going] += change
            slopes[going] += self._cj * change
            there, residuals[going], sizes = self._looked_at(rows[going], errors[going], slopes[going])
            nearer = sizes < self.sizes[rows[going]]
            kept, best = going[nearer], rows[going[nearer]]
            self.q[best], self.u[best], self.sizes[best] = there.q[nearer], there.u[nearer], sizes[nearer]
            self._errors[best], self._slopes[best] = errors[kept], slopes[kept]
            self._residuals[best] = residuals[kept]
            on = (sizes < CONSISTENCY.restored * last[0][going]) & (sizes > self._enough[rows[going]])
            last = [last[1], last[1].copy()]
            last[1][going] = sizes  # one correction may move the residual to other directions
            going = going[on]

    def _looked_at(
        self, rows: np.ndarray, errors: np.ndarray, slopes: np.ndarray
    ) -> tuple[Evaluated, np.ndarray, np.ndarray]:
        """Return the states without some errors, the residuals e' - F(z) + F(z - e) - d and their sizes."""
        at = self._at.at(rows)
        there = evaluated(self._dynamics, at.t, *displaced(self._dynamics.system, at.q, at.u, -errors))
        residuals = slopes + rate_changes(self._dynamics.system, at, there)
        return there, residuals, self._size(rows, residuals)

    def _size(self, rows: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return the largest tangent component of some rates."""
        return np.asarray(np.abs(self._left[rows] @ rates[..., None]).max(axis=(1, 2)))
