"""Errors that satisfy their equation at each recorded state, not only to first order.

An error e of a pose stretches a stiff spring by e^2 times its curvature: 1e-10 m at 1e-5 rad are 100 N at 1e12 N/m. Linear equations
do not balance such forces. Newton's iteration on e' = F(z) - F(z - e) + d, with e' of the transport, does so in the directions that
are stiff within a step. Its moves are of the second order in e: larger ones, as by friction that changes its sign, are not taken.
"""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.native.parameters import CONSISTENCY
from .coordinates import as_rows, displaced
from .evaluated import Evaluated, evaluated, motion
from .parameters import ESTIMATE
from .transport import Transport


def closed(
    dynamics: Dynamics, transport: Transport, at: Evaluated, errors: np.ndarray, slopes: np.ndarray, defects: np.ndarray,
    steps: np.ndarray, typical: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Return q and u of states without their errors (dq, du, ds), closed onto the equations where that is possible, and two masks.

    The first is that of states which are far from the equations, the second that of all others than closed ones.

    `slopes`, `defects`: e' and d at the states, NaN where they are unknown. `steps` of shape (n,): longest step of the piece of each
    state, s; as in a stiff projection, the matrix of a part of it separates the directions that are stiff. `typical` of shape
    (n, full): sizes of changes that are large.
    """
    (q, u), open_ = displaced(dynamics.system, at.q, at.u, -errors), np.zeros(len(errors), dtype=bool)
    is_open = np.ones(len(errors), dtype=bool)
    is_known = np.isfinite(slopes + defects).all(axis=1)
    open_[~is_known] = _out_of_balance(dynamics, at.at(~is_known), q[~is_known], u[~is_known], typical[~is_known])
    known = np.flatnonzero(is_known)
    if not len(known):
        return q, u, open_, is_open
    rows, cj = np.arange(len(known)), CONSISTENCY.step_parts / steps[known]
    iteration = _Iteration(
        dynamics, transport, at.at(known), errors[known], slopes[known], defects[known], cj, typical[known]
    )
    iteration.take(rows, at.at(known))
    rows = iteration.open(rows)
    while len(rows):
        sizes = iteration.sizes[rows]
        iteration.take(rows, iteration.states(rows))
        rows = iteration.open(rows[iteration.sizes[rows] < CONSISTENCY.restored * sizes])
    q[known], u[known], open_[known] = iteration.q, iteration.u, iteration.fails
    is_open[known] = False
    is_open[known[iteration.open(np.arange(len(known)))]] = True
    return q, u, open_, is_open


def _out_of_balance(dynamics: Dynamics, at: Evaluated, q: np.ndarray, u: np.ndarray, typical: np.ndarray) -> np.ndarray:
    """Return a mask of states, by q and u without their errors, whose rates differ by more than those of the motion."""
    here, there = (motion(dynamics.system, each) for each in (at, evaluated(dynamics, at.t, q, u)))
    return np.asarray(np.abs((there - here) / typical).max(axis=1) > np.abs(here / typical).max(axis=1))


class _Iteration:
    """Newton's iteration of many states; `q`, `u` and `sizes` are the states with the least residuals so far, and these."""

    def __init__(
        self, dynamics: Dynamics, transport: Transport, at: Evaluated, errors: np.ndarray, slopes: np.ndarray,
        defects: np.ndarray, cj: np.ndarray, typical: np.ndarray,
    ) -> None:  # fmt: skip
        self._dynamics, self._transport, self._at, self._cj = dynamics, transport, at, cj
        self._typical, self._errors, self._slopes, self._defects = typical, errors, slopes, defects
        rows = np.arange(len(errors))
        self._linear, self._most = errors.copy(), ESTIMATE.smooth * self._size(rows, errors)
        of_errors, of_motion = (self._size(rows, each) for each in (slopes, motion(dynamics.system, at)))
        self._much = np.maximum(of_errors, ESTIMATE.large * of_motion)
        self._enough = np.maximum(ESTIMATE.large * of_errors, ESTIMATE.difference * of_motion)
        there, self._residuals, self.sizes = self._looked_at(rows, errors, slopes)
        self.q, self.u = there.q.copy(), there.u.copy()

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

    def take(self, rows: np.ndarray, at: Evaluated) -> None:
        """Iterate with the matrices at some states while that brings these rows nearer to the equations."""
        errors, slopes, residuals = self._errors[rows], self._slopes[rows], self._residuals[rows]
        last, going = [np.full(len(rows), np.inf), self.sizes[rows]], np.arange(len(rows))
        going = going[self.sizes[rows] > self._enough[rows]]
        while len(going):
            cj = self._cj[rows[going]]
            change = -self._transport.corrections(at.at(going), cj, residuals[going])
            errors[going] += change
            slopes[going] += cj[:, None] * change
            there, residuals[going], sizes = self._looked_at(rows[going], errors[going], slopes[going])
            moved = self._size(rows[going], errors[going] - self._linear[rows[going]])
            nearer = (sizes < self.sizes[rows[going]]) & (moved <= self._most[rows[going]])
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
        change = as_rows(self._dynamics.system, there.q_rates - at.q_rates, there.acceleration - at.acceleration)
        residuals = slopes - self._defects[rows] + change
        sizes = self._size(rows, residuals)
        open_ = np.flatnonzero(sizes > self._enough[rows])
        if len(open_) and self._dynamics.system.n_c:
            sizes[open_] = self._size(rows[open_], self._transport.tangent(at.at(open_), residuals[open_]))
        return there, residuals, sizes

    def _size(self, rows: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return the largest part of some rates at some rows in those that are large for the motion."""
        return np.asarray(np.abs(rates / self._typical[rows]).max(axis=1))
