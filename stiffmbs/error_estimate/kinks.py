"""Integrals of the equations over steps of radau in which their right-hand side is not smooth, as at the knots of a spline.

The nine points of a step integrate a kink with an error of a hundredth of its jump times the square of the step. That is often
more than the error of the step: the error test sees only the points of the method.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from ..solve.radau.collocation import radau
from ..solve.recorded_steps import Piece
from .parameters import ESTIMATE

GAUSS_NODES, GAUSS_WEIGHTS = (0.5 * (leggauss(3)[0] + 1.0), 0.5 * leggauss(3)[1])
"""Gauss quadrature of order 6 on the interval from 0 to 1."""
Motion = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Rates z' as rows (dq, du, ds) from t, q and u of many states."""


def not_smooth(rates: np.ndarray, sizes: np.ndarray, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the steps over which the quadrature by their points may be inaccurate, and the largest local error of the others.

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
    return np.flatnonzero(chosen & are_isolated), largest


def integrals_of_motion(piece: Piece, steps: np.ndarray, motion: Motion, scale: np.ndarray) -> np.ndarray:
    """Return the integrals of z' from the starts of steps to their points, shape (steps, points, full), by adaptive quadrature.

    `scale` of shape (full,): sizes to which errors of the integrals are relative.
    """
    points, n_q = piece.points, piece.q.shape[1]
    ends = np.append(0.0, radau(points).nodes)
    rows = steps[:, None] * points + np.arange(points + 1)
    states, start = np.hstack([piece.q, piece.u])[rows], piece.t[rows[:, 0]]
    size = piece.t[rows[:, -1]] - start
    to_coefficients = np.linalg.inv(legvander(2.0 * ends - 1.0, points))

    def integrated(begin: np.ndarray, end: np.ndarray, of_step: np.ndarray) -> np.ndarray:
        at = begin[:, None] + (end - begin)[:, None] * GAUSS_NODES
        weights = legvander(2.0 * at - 1.0, points) @ to_coefficients
        z = np.einsum("ngp,npj->ngj", weights, states[of_step]).reshape(at.size, -1)
        rates = motion((start[of_step, None] + size[of_step, None] * at).ravel(), z[:, :n_q], z[:, n_q:])
        mean = np.einsum("g,ngf->nf", GAUSS_WEIGHTS, rates.reshape(*at.shape, -1))
        return np.asarray(mean * (size[of_step] * (end - begin))[:, None])

    owner = np.arange(len(steps) * points)
    begin, end = (np.tile(each, len(steps)) for each in (ends[:-1], ends[1:]))
    whole = integrated(begin, end, owner // points)
    found = np.zeros_like(whole)
    for _ in range(ESTIMATE.halvings):
        middle, of_step = 0.5 * (begin + end), owner // points
        halves = integrated(begin, middle, of_step), integrated(middle, end, of_step)
        both = halves[0] + halves[1]
        open_ = (np.abs(both - whole) > ESTIMATE.smooth**2 * scale).any(axis=1)
        np.add.at(found, owner[~open_], both[~open_])
        begin, end = (np.concatenate(pair) for pair in ((begin[open_], middle[open_]), (middle[open_], end[open_])))
        whole, owner = np.concatenate([half[open_] for half in halves]), np.tile(owner[open_], 2)
        if not len(begin):
            break
    np.add.at(found, owner, whole)
    return np.cumsum(found.reshape(len(steps), points, -1), axis=1)
