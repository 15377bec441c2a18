"""State matrix of the linearised equations, with as many variations as degrees of freedom.

Poses vary by x = W a + Q s with G W = 0 and G Q = -G_s; velocities vary by v = N b + P (a, s) with J N = 0. L^T B = 0
eliminates the multipliers (null space method; Negrut and Ortiz, J. Comput. Nonlinear Dyn. 1, 2006).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import SolverError
from .parameters import LINEAR_ANALYSIS
from .tangent_space import Linearised


@dataclass(frozen=True)
class StateMatrix:
    """State matrix of z' = A z with z = (a, b, s); s are the user-defined states.

    - `matrix` of shape (n, n): A; n is twice the degrees of freedom, plus one for each rolling constraint and each
      state.
    - `poses` of shape (n_u, n): x from z: displacements and rotations of all bodies, ground axes.
    - `velocities` of shape (n_u, n): v from z.
    - `accelerations` of shape (n_u, n): v' from z.
    - `forced` of shape (n, n_u): z' from generalised forces on the bodies, ground axes.
    - `n_poses`: length of a.
    - `n_states`: length of s.
    """

    matrix: np.ndarray
    poses: np.ndarray
    velocities: np.ndarray
    accelerations: np.ndarray
    forced: np.ndarray
    n_poses: int
    n_states: int

    @property
    def degrees_of_freedom(self) -> int:
        """Length of b: the number of free velocities."""
        return len(self.matrix) - self.n_poses - self.n_states


def state_matrix(linear: Linearised, scale: np.ndarray) -> StateMatrix:
    """Eliminate the constraints from linearised equations.

    `scale` of shape (n_u,): units of the variations of velocities: lengths for displacements, 1 for rotations. Raises
    SolverError when a free motion has no mass.
    """
    constraints = Constraints(linear.velocity * scale)
    free = constraints.null_space * scale[:, None]
    poses, left = (
        free if np.array_equal(matrix, linear.velocity) else null_space(matrix * scale) * scale[:, None]
        for matrix in (linear.position, linear.reactions.T)
    )
    n_a, n_b, n_s = poses.shape[1], free.shape[1], len(linear.rate_by_states)
    s = np.hstack([np.zeros((n_s, n_a + n_b)), np.eye(n_s)])
    led = _following(Constraints(linear.position * scale), linear.position_by_states, scale)
    x = np.hstack([poses, np.zeros((len(scale), n_b)), led])
    v = _following(constraints, linear.velocity_at_position @ x + linear.velocity_by_states @ s, scale)
    v[:, n_a : n_a + n_b] += free
    n = n_a + n_b + n_s
    asked = (
        linear.acceleration_at_position @ x + linear.acceleration_at_velocity @ v + linear.acceleration_by_states @ s
    )
    carried = _following(constraints, asked, scale)
    acting = linear.stiffness @ x + linear.damping @ v + linear.by_states @ s
    force = left.T @ (acting - linear.mass @ carried)
    accelerations = _solved(left.T @ linear.mass @ free, np.hstack([force, left.T]))
    found = carried + free @ accelerations[:, :n]
    rates_of_states = linear.rate_by_pose @ x + linear.rate_by_velocity @ v + linear.rate_by_states @ s
    forced = np.zeros((n_s, len(scale)))
    if np.any(linear.rate_by_reactions):
        reactions = np.linalg.pinv(linear.reactions)
        rates_of_states += linear.rate_by_reactions @ reactions @ (acting - linear.mass @ found)
        forced = linear.rate_by_reactions @ reactions @ (np.eye(len(scale)) - linear.mass @ free @ accelerations[:, n:])
    rates = (poses / scale[:, None]).T @ ((v - led @ rates_of_states) / scale[:, None])
    moved = (poses / scale[:, None]).T @ (-(led @ forced) / scale[:, None])
    return StateMatrix(
        matrix=np.vstack([rates, accelerations[:, :n], rates_of_states]),
        poses=x,
        velocities=v,
        accelerations=found,
        forced=np.vstack([moved, accelerations[:, n:], forced]),
        n_poses=n_a,
        n_states=n_s,
    )


def _following(constraints: Constraints, missing: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return the smallest velocities or accelerations that cancel a violation by J; zero if there is none."""
    if not np.any(missing):
        return np.zeros((len(scale), missing.shape[1]))
    return scale[:, None] * constraints.smallest(-missing)


def _solved(inertia: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return the accelerations of the free motions from the forces."""
    if not len(inertia):
        return np.zeros(forces.shape)
    sizes = np.linalg.norm(inertia, axis=1)
    if not np.all(sizes > 0) or np.linalg.cond(inertia / sizes[:, None]) > LINEAR_ANALYSIS.singular:
        raise SolverError(
            "a motion that the joints leave free has no mass, expected mass or inertia in every free motion"
        )
    found: np.ndarray = np.linalg.solve(inertia, forces)
    return found


def null_space(matrix: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the null space of a matrix, by QR of its transpose with column pivoting.

    `matrix` of shape (m, n). Returns an array of shape (n, n - rank).
    """
    return Constraints(matrix).null_space


class Constraints:
    """Factorized equations A x = b: A^T with normalised rows of A, pivoted, is Q R. `matrix` of shape (m, n): A."""

    def __init__(self, matrix: np.ndarray) -> None:
        self._norms = np.linalg.norm(matrix, axis=1)
        self._rows = np.flatnonzero(self._norms > 0)
        self._q, self._r, self._order = np.eye(matrix.shape[1]), np.zeros((0, 0)), np.zeros(0, dtype=int)
        if len(self._rows):
            from scipy.linalg import qr

            self._q, self._r, self._order = qr((matrix[self._rows] / self._norms[self._rows, None]).T, pivoting=True)
        pivots = np.abs(np.diag(self._r))
        self._rank = int(np.sum(pivots > LINEAR_ANALYSIS.dependent * pivots[0])) if len(pivots) else 0

    @property
    def null_space(self) -> np.ndarray:
        """Orthonormal basis of the null space of A, shape (n, n - rank)."""
        return np.ascontiguousarray(self._q[:, self._rank :])

    def smallest(self, right: np.ndarray) -> np.ndarray:
        """Return the smallest x with A x = b for columns b that are consistent where equations are dependent."""
        from scipy.linalg import solve_triangular

        first = self._rows[self._order[: self._rank]]
        inner = solve_triangular(
            self._r[: self._rank, : self._rank], right[first] / self._norms[first, None], trans="T"
        )
        return np.asarray(self._q[:, : self._rank] @ inner)
