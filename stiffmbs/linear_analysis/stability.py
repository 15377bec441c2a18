"""Stability of an equilibrium at rest: the lowest w^2 of K x + J^T l = w^2 M x, J x = 0, and its free motions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, splu

from ..dynamics.dynamics import Dynamics
from ..equilibria.matrices import Matrix, dense
from ..equilibria.steady_motion import SteadyMotion
from ..sparse.parameters import MATRICES
from .parameters import LINEAR_ANALYSIS
from .state_space import null_space, state_matrix
from .tangent_space import linearised

STIFFNESS_ROUNDING = 2 * float(np.finfo(float).eps)
"""Error of w^2, relative to the sum of all contributions to a motion's stiffness."""


@dataclass(frozen=True)
class Lowest:
    """Lowest w^2 of an equilibrium, and their motions.

    `squares` of shape (k,): real parts of w^2, 1/s^2; negative ones are unstable. `shapes` of shape (n_u, k): motions,
    as velocities of all bodies. `none` of shape (k,): bound up to which each w^2 counts as zero.
    """

    squares: np.ndarray
    shapes: np.ndarray
    none: np.ndarray

    @property
    def unstable(self) -> np.ndarray:
        """Most unstable motion as the only column, shape (n_u, 1); shape (n_u, 0) if all are stable."""
        found = np.flatnonzero(self.squares < -self.none)
        return self.shapes[:, found[np.argsort(self.squares[found])][:1]]

    @property
    def free(self) -> np.ndarray:
        """Motions without stiffness, in columns."""
        return self.shapes[:, np.abs(self.squares) <= self.none]


def lowest(stiffness: Matrix, jacobian: Matrix, mass: np.ndarray, scale: np.ndarray, left: np.ndarray) -> Lowest:
    """Return the lowest w^2 of an equilibrium.

    `stiffness` of shape (n_u, n_u): K: negative derivative of forces, with the reactions, by displacements. `jacobian`
    of shape (n_c, n_u): J of independent equations. `mass` of shape (n_u,): the diagonal of M. `scale` of shape
    (n_u,): units of displacements. `left` of shape (n_u,): residual of the forces.
    """
    if len(mass) <= MATRICES.dense_up_to:
        squares, shapes = _all(stiffness, jacobian, mass, scale)
        of_eigenvalues = STIFFNESS_ROUNDING * len(mass) * float(np.max(np.abs(squares), initial=0.0))
    else:
        squares, shapes = _near(csc_array(stiffness), csc_array(jacobian), mass, scale)
        of_eigenvalues = 0.0
    inertia = np.sum(shapes * (mass[:, None] * shapes), axis=0)
    sizes = np.abs(shapes)
    rounding = STIFFNESS_ROUNDING * np.sum(sizes * (abs(stiffness) @ sizes), axis=0)
    of_imbalance = LINEAR_ANALYSIS.imbalance * (np.abs(left) / scale) @ sizes**2
    none = (rounding + of_imbalance) / np.where(inertia > 0, inertia, np.inf) + of_eigenvalues
    real = np.abs(squares.imag) <= LINEAR_ANALYSIS.close * np.abs(squares) + none
    return Lowest(squares[real].real, shapes[:, real], none[real])


def _all(stiffness: Matrix, jacobian: Matrix, mass: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    free = null_space(dense(jacobian) * scale) * scale[:, None]
    if not free.shape[1]:
        return np.zeros(0, dtype=complex), np.zeros((len(mass), 0))
    values, vectors = np.linalg.eig(np.linalg.solve(free.T @ (mass[:, None] * free), free.T @ (stiffness @ free)))
    return values, _real_shapes(values, free @ vectors)


def _real_shapes(values: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Return real motions with the same span: the real and imaginary parts of a pair."""
    return np.where(values.imag < 0.0, shapes.imag, shapes.real)


def _near(
    stiffness: csc_array, jacobian: csc_array, mass: np.ndarray, scale: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return negative w^2, and those next to zero, by shift-invert Arnoldi iteration on the sparse equations.

    The shifts are below zero, a decade apart: each negative w^2 has a shift nearer to it than to any nonnegative one
    (Lehoucq, Sorensen, Yang, ARPACK Users' Guide, SIAM 1998).
    """
    n, rows = len(mass), jacobian.shape[0]
    largest = float(np.max(abs(stiffness) @ scale / (mass * scale), initial=0.0))
    values, vectors = [np.zeros(0, dtype=complex)], [np.zeros((n, 0))]
    start = np.cos(np.arange(1, n + 1, dtype=float) ** 2)
    last = max(LINEAR_ANALYSIS.least_shift * largest, np.finfo(float).tiny)
    for shift in last * 10.0 ** np.arange(max(np.log10(max(largest, last) / last), 0) + 1):
        whole = block_array(
            [[stiffness + shift * diags_array(mass), jacobian.T], [jacobian, csc_array((rows, rows))]], format="csc"
        )
        try:
            of_inverse, shapes = _largest_of_inverse(
                whole, mass, LINEAR_ANALYSIS.most_free if shift == last else 1, start
            )
        except RuntimeError:  # exactly singular
            continue
        found = 1.0 / of_inverse - shift
        kept = (found.real < -LINEAR_ANALYSIS.own * shift) | (shift == last)
        values.append(found[kept])
        vectors.append(_real_shapes(found[kept], shapes[:, kept]))
    return np.concatenate(values), np.hstack(vectors)


def _largest_of_inverse(
    whole: csc_array, mass: np.ndarray, count: int, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the converged largest eigenvalues of x -> (K + s M)^-1 M x on the constraints, and their eigenvectors."""
    n, rows = len(mass), whole.shape[0] - len(mass)
    solve = splu(whole).solve
    operator = LinearOperator((n, n), lambda x: solve(np.append(mass * x, np.zeros(rows)))[:n], dtype=float)
    try:
        found: tuple[np.ndarray, np.ndarray] = eigs(
            operator, k=count, v0=start, tol=LINEAR_ANALYSIS.accuracy, maxiter=LINEAR_ANALYSIS.most_restarts
        )
    except ArpackNoConvergence as some:
        return some.eigenvalues, some.eigenvectors
    return found


def eigenvalues_about(
    dynamics: Dynamics, t: float, motion: SteadyMotion, acceleration: np.ndarray
) -> np.ndarray | None:
    """Return the eigenvalues about a steady motion, 1/s; None if coefficients are not constant in the comoving frame.

    With W x the rotation of the frame, variations in it change by x' = v - W x and v' = a - W v. Neutral motions, such
    as one along the motion itself, are included as zeros. `dynamics`: at a state of the motion, with its multipliers.
    `t`: s. `acceleration` of shape (n_u,): u' of the motion. Raises SolverError when a free motion has no mass.
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
    if np.linalg.norm(values @ matrix - rates) > LINEAR_ANALYSIS.close * np.linalg.norm(rates):
        return None
    found: np.ndarray = np.linalg.eigvals(matrix)
    return found[np.lexsort((found.imag, -found.real))]
