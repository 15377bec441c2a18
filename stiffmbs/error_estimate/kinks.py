"""Integrals of the equations over steps in which their right-hand side is not smooth, as at the knots of a spline.

The nine points of a step of radau integrate a kink with an error of a hundredth of its jump times the square of the step. That is
often more than the error of the step: the error test sees only the points of the method. The three points of a step of bdf have
larger errors still: a polynomial through states on both sides of a kink leaves the constraints.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legder, leggauss, legval, legvander

from ..solve.radau.collocation import Collocation, radau
from .parameters import ESTIMATE

ENDS = np.array([-1.0, 1.0])
"""Ends of the interval of Legendre polynomials."""
GAUSS_NODES, GAUSS_WEIGHTS = (0.5 * (leggauss(3)[0] + 1.0), 0.5 * leggauss(3)[1])
"""Gauss quadrature of order 6 on the interval from 0 to 1."""
_OF_ENDS = np.linalg.inv(
    np.vstack([legvander(ENDS, 3), np.transpose([legval(ENDS, legder(row)) for row in np.eye(4)])])
)
"""Legendre coefficients of a cubic by its values and slopes at -1 and 1."""
Motion = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Rates z' as rows (dq, du, ds) from t, q and u of many states."""


@dataclass(frozen=True, eq=False)
class Curve:
    """Polynomials through the states (q, u) of some steps.

    - `start`, `size` of shape (steps,): times of the starts and lengths of the steps, s.
    - `coefficients` of shape (steps, degree + 1, n_q + n_u): those of Legendre polynomials, from -1 to 1 over the step.
    """

    start: np.ndarray
    size: np.ndarray
    coefficients: np.ndarray

    @classmethod
    def through(cls, t: np.ndarray, states: np.ndarray, start: np.ndarray, end: np.ndarray) -> Curve:
        """Return the polynomials through states, shape (steps, k, n), at times of shape (steps, k)."""
        x = (2.0 * t - start[:, None] - end[:, None]) / (end - start)[:, None]
        return cls(start, end - start, np.linalg.solve(legvander(x, t.shape[1] - 1), states))

    @classmethod
    def of_ends(cls, t: np.ndarray, states: np.ndarray, rates: np.ndarray) -> Curve:
        """Return the cubic polynomials by the states and rates at both ends of steps, shape (steps, 2, n)."""
        size = t[:, 1] - t[:, 0]
        slopes = 0.5 * size[:, None, None] * rates
        return cls(t[:, 0], size, _OF_ENDS @ np.concatenate([states, slopes], axis=1))

    def at(self, places: np.ndarray, of_step: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return times and states at places, shape (n, m), from 0 to 1 within the steps `of_step`, one in each row."""
        t = self.start[of_step, None] + self.size[of_step, None] * places
        weights = legvander(2.0 * places - 1.0, self.coefficients.shape[1] - 1)
        states = np.einsum("nmk,nkj->nmj", weights, self.coefficients[of_step])
        return t.ravel(), states.reshape(t.size, states.shape[2])

    def slopes(self, places: np.ndarray) -> np.ndarray:
        """Return the derivatives at places, from 0 to 1, within all steps, shape (steps, places, n), 1/s."""
        derivatives = legder(self.coefficients, axis=1) * (2.0 / self.size)[:, None, None]
        return np.asarray(legvander(2.0 * places - 1.0, derivatives.shape[1] - 1) @ derivatives)

    def errors_of_slopes(self, method: Collocation) -> np.ndarray:
        """Return the errors of the slopes by collocation at its points of all steps, shape (steps, points, n), 1/s.

        They are z' - sum_j D_ij (z_j - z_0) / h.
        """
        values = legvander(2.0 * np.append(0.0, method.nodes) - 1.0, self.coefficients.shape[1] - 1) @ self.coefficients
        changes = (values[:, 1:] - values[:, :1]) / self.size[:, None, None]
        return self.slopes(method.nodes) - method.derivative @ changes


def not_smooth(rates: np.ndarray, sizes: np.ndarray, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a mask of steps whose quadrature by their points may be inaccurate, and the largest local error of the others.

    Errors of the quadrature are compared with this largest local error, shape (full,).

    The error of the quadrature is estimated from the decay of the Legendre coefficients of z', shape (steps, points, full): that
    of the first one that it does not integrate, whose degree is twice that of the last known one. `sizes` of shape (steps,):
    lengths, s. `local` of shape (steps, points, full): integrals of the defects.
    """
    points = rates.shape[1]
    inverse = np.linalg.inv(legvander(2.0 * radau(points).nodes - 1.0, points - 1))
    coefficients = np.abs(np.einsum("kp,npf->nkf", inverse, rates))
    last, before = coefficients[:, -2:].max(axis=1), coefficients[:, -4:-2].max(axis=1)
    decay = np.minimum(1.0, last / np.maximum(before, np.finfo(float).tiny))
    error = sizes[:, None] * last * decay ** (points / 2)
    chosen, ends = np.zeros(len(sizes), dtype=bool), np.abs(local[:, -1])
    for _ in range(2):
        largest = ends[~chosen].max(axis=0, initial=np.finfo(float).tiny)
        chosen = (error > ESTIMATE.smooth * largest).any(axis=1)
    are_isolated = np.count_nonzero(chosen) <= ESTIMATE.isolated * len(chosen)  # otherwise rounding of stiff forces
    return chosen & are_isolated, largest


def dominant(sizes: np.ndarray) -> np.ndarray:
    """Return a mask of steps whose local errors, with sizes of shape (steps,), are above their mean and far above their median."""
    median = np.sort(sizes)[len(sizes) // 2]
    return np.asarray(sizes > max(sizes.mean(), median / ESTIMATE.smooth))


def integrals_of_motion(
    curve: Curve, ends: np.ndarray, n_q: int, motion: Motion, scale: np.ndarray, most: float
) -> np.ndarray:
    """Return the integrals of z' from the starts of steps to places in them, shape (steps, places, full), by adaptive quadrature.

    `ends`: 0 and the places, from 0 to 1. `n_q`: number of coordinates. `scale` of shape (full,): sizes to which errors of the
    integrals are relative. `most`: largest number of intervals to halve.
    """
    steps, places = len(curve.start), len(ends) - 1

    def integrated(begin: np.ndarray, end: np.ndarray, of_step: np.ndarray) -> np.ndarray:
        """Return the integrals of the motion's rates over parts of steps."""
        at = begin[:, None] + (end - begin)[:, None] * GAUSS_NODES
        t, z = curve.at(at, of_step)
        rates = motion(t, z[:, :n_q], z[:, n_q:]).reshape(*at.shape, -1)
        return np.asarray(np.einsum("g,ngf->nf", GAUSS_WEIGHTS, rates) * (curve.size[of_step] * (end - begin))[:, None])

    owner = np.arange(steps * places)
    begin, end = (np.tile(each, steps) for each in (ends[:-1], ends[1:]))
    whole = integrated(begin, end, owner // places)
    found = np.zeros_like(whole)
    while 0 < len(begin) <= most:
        most -= len(begin)
        middle, of_step = 0.5 * (begin + end), owner // places
        halves = integrated(begin, middle, of_step), integrated(middle, end, of_step)
        both = halves[0] + halves[1]
        open_ = (np.abs(both - whole) > ESTIMATE.smooth**2 * scale).any(axis=1)
        np.add.at(found, owner[~open_], both[~open_])
        begin, end = (np.concatenate(pair) for pair in ((begin[open_], middle[open_]), (middle[open_], end[open_])))
        whole, owner = np.concatenate([half[open_] for half in halves]), np.tile(owner[open_], 2)
    np.add.at(found, owner, whole)
    return np.cumsum(found.reshape(steps, places, -1), axis=1)
