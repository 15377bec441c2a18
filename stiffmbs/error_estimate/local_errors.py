"""Defects of steps with large local errors, by Newton's iteration on the collocation equations of each step.

The error x of z_i solves d_i = sum_j D_ij x_j / h - (F(z_i) - F(z_i - x_i)). One linear correction leaves a remainder of the second
order in x, which stretches stiff springs.
"""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.native.parameters import CONSISTENCY
from ..solve.radau.collocation import radau
from .coordinates import displaced
from .defects import Points
from .evaluated import evaluated
from .parameters import ESTIMATE
from .restarts import motion
from .transport import Transport


def nonlinear_defects(
    dynamics: Dynamics, transport: Transport, points: Points, unknowns: np.ndarray, defects: np.ndarray, steps: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return defects by which linear equations give the errors of some steps from their starts, and a mask of those that converge.

    `unknowns`: `Transport.rows` at the points of all steps. `defects`: defects there, shape (steps, points, full).
    """
    rows, sizes, n_q = points.rows[steps, 1:], points.sizes[steps], points.system.n_q
    exact, derivative = points.changes_of(points.exact[rows]), radau(points.points).derivative
    errors, total = np.zeros_like(exact), np.zeros_like(exact)
    last, converged, going = np.full(len(steps), np.inf), np.zeros(len(steps), dtype=bool), np.arange(len(steps))
    while len(going):
        states = points.states[rows[going]].reshape(-1, points.states.shape[1])
        q, u = displaced(points.system, states[:, :n_q], states[:, n_q:], -errors[going].reshape(len(states), -1))
        at = evaluated(dynamics, points.t[rows[going]].ravel(), np.ascontiguousarray(q), np.ascontiguousarray(u))
        there = motion(points.system, at).reshape(exact[going].shape)
        slopes = derivative @ errors[going] / sizes[going, None, None]
        residuals = defects[steps[going]] + exact[going] - there - slopes
        change = transport.apart(unknowns[steps[going]], sizes[going], residuals)
        errors[going] += change
        total[going] += residuals
        size, whole = (np.abs(each / points.typical).max(axis=(1, 2)) for each in (change, errors[going]))
        converged[going] = size <= ESTIMATE.large * whole
        nearer = size <= CONSISTENCY.restored * last[going]
        last[going] = size
        going = going[nearer & ~converged[going]]
    return total, converged
