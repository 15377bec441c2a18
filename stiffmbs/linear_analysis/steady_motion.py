"""Stability of steady motions: eigenvalues in the comoving frame, in which the coefficients are constant."""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..equilibria.steady_motion import SteadyMotion
from .eigenvalues import CLOSE
from .state_space import state_matrix
from .tangent_space import linearised


def eigenvalues_beside(
    dynamics: Dynamics, t: float, motion: SteadyMotion, acceleration: np.ndarray
) -> np.ndarray | None:
    """Return the eigenvalues about a steady motion, 1/s; None if coefficients are not constant in the comoving frame.

    With W x the rotation of the frame, variations in it change by x' = v - W x and v' = a - W v. Neutral motions, such
    as one along the motion itself, are included as zeros.

    Parameters
    ----------
    dynamics : Dynamics
        At a state of the motion, with its multipliers.
    t : float
        s.
    acceleration : ndarray, shape (n_u,)
        u' of the motion.

    Raises
    ------
    SolverError
        When a free motion has no mass.
    """
    system = dynamics.system
    scale = system.per_velocity(system.size, 1.0)
    state = state_matrix(linearised(dynamics, t, acceleration), scale)
    turning = motion.turning(system)
    own = state.matrix[len(state.matrix) - state.n_states :]
    states = np.eye(len(state.matrix))[len(state.matrix) - state.n_states :]
    values = np.vstack([*(part / scale[:, None] for part in (state.poses, state.velocities)), states])
    x, v = state.velocities - turning @ state.poses, state.accelerations - turning @ state.velocities
    rates = np.vstack([x / scale[:, None], v / scale[:, None], own])
    matrix, *_ = np.linalg.lstsq(values, rates, rcond=None)
    if np.linalg.norm(values @ matrix - rates) > CLOSE * np.linalg.norm(rates):
        return None
    found: np.ndarray = np.linalg.eigvals(matrix)
    return found[np.lexsort((found.imag, -found.real))]
