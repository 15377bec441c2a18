"""Integrals of the equations over steps of radau in which their right-hand side is not smooth, as at the knots of a spline.

The nine points of a step integrate a kink with an error of a hundredth of its jump times the square of the step, which is
often more than the error of the step: those that are accepted are those in which a kink happens to do no harm.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from scipy.interpolate import BarycentricInterpolator

from ..solve.radau.collocation import radau
from ..solve.recorded_steps import Piece
from .parameters import ESTIMATE

GAUSS_NODES, GAUSS_WEIGHTS = (0.5 * (leggauss(3)[0] + 1.0), 0.5 * leggauss(3)[1])
"""Gauss quadrature of order 6 on the interval from 0 to 1."""
Motion = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Rates z' as rows (dq, du, ds) from t, q and u of many states."""


def not_smooth(rates: np.ndarray, sizes: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Return the steps over which the quadrature by the points of a step may be too inaccurate.

    Its error is estimated from the decay of the Legendre coefficients of z', shape (steps, points, full): that of the first one
    that it does not integrate, whose degree is twice that of the last known one. `sizes` of shape (steps,): lengths, s. `local`
    of shape (steps, points, full): integrals of the defects.
    """
    points = rates.shape[1]
    inverse = np.linalg.inv(legvander(2.0 * radau(points).nodes - 1.0, points - 1))
    coefficients = np.abs(np.einsum("kp,npf->nkf", inverse, rates))
    last, before = coefficients[:, -2:].max(axis=1), coefficients[:, -4:-2].max(axis=1)
    decay = np.minimum(1.0, last / np.maximum(before, np.finfo(float).tiny))
    error = sizes[:, None] * last * decay ** (points / 2)
    return np.flatnonzero((error > ESTIMATE.smooth * np.abs(local[:, -1]).max(axis=0)).any(axis=1))


def integrals_of_motion(piece: Piece, step: int, motion: Motion, scale: np.ndarray) -> np.ndarray:
    """Return the integrals of z' from the start of a step to its points, shape (points, full), by adaptive quadrature.

    `scale` of shape (full,): sizes to which errors of the integrals are relative.
    """
    points = piece.points
    rows = slice(step * points, (step + 1) * points + 1)
    t, count = piece.t[rows], piece.q.shape[1]
    size = t[-1] - t[0]
    curve = BarycentricInterpolator((t - t[0]) / size, np.hstack([piece.q[rows], piece.u[rows]]))

    def integrated(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        at = begin[:, None] + (end - begin)[:, None] * GAUSS_NODES
        states = curve(at.ravel())
        rates = motion(t[0] + size * at.ravel(), states[:, :count], states[:, count:])
        return np.einsum("k,nkf->nf", GAUSS_WEIGHTS, rates.reshape(*at.shape, -1)) * (size * (end - begin))[:, None]

    ends = np.append(0.0, radau(points).nodes)
    begin, end, owner = ends[:-1], ends[1:], np.arange(points)
    whole = integrated(begin, end)
    found = np.zeros_like(whole)
    for _ in range(ESTIMATE.halvings):
        middle = 0.5 * (begin + end)
        halves = integrated(begin, middle), integrated(middle, end)
        off = (np.abs(halves[0] + halves[1] - whole) / scale).max(axis=1)
        open_ = off > ESTIMATE.smooth**2
        np.add.at(found, owner[~open_], (halves[0] + halves[1])[~open_])
        begin, end = (np.concatenate(pair) for pair in ((begin[open_], middle[open_]), (middle[open_], end[open_])))
        whole, owner = np.concatenate([half[open_] for half in halves]), np.tile(owner[open_], 2)
        if not len(begin):
            break
    np.add.at(found, owner, whole)
    return np.cumsum(found, axis=0)
