"""The stability of an equilibrium at rest, and what is free in it: K x + J^T l = w^2 M x, J x = 0 for the lowest w^2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, splu

from .state_space import null_space

MOST_DENSE = 300
"""Velocities up to which all w^2 are computed (dense matrices)."""
STIFFNESS_ROUNDING = 2 * float(np.finfo(float).eps)
"""Part of the sum of all parts of a motion's stiffness that its w^2 may be off by."""
BESIDE_IMBALANCE = 100.0
"""Times the w^2 that what is left of the forces could make."""
LEAST_SHIFT = 1e-14
"""The least shift, relative to the largest w^2 that a body could have by itself."""
MOST_FREE, MOST_RESTARTS, ACCURACY = 6, 5, 1e-3
"""Of Arnoldi's iteration: motions sought at the last shift, restarts, and relative accuracy."""
OWN = 0.05
"""Part of a shift that a negative w^2 has at the least where that shift is the one nearest to it."""


@dataclass(frozen=True)
class Lowest:
    """The lowest w^2 of an equilibrium, and their motions.

    Attributes
    ----------
    squares : ndarray, shape (k,)
        Real parts of w^2, 1/s^2; negative ones are unstable.
    shapes : ndarray, shape (n_u, k)
        Motions, as velocities of all bodies.
    none : ndarray, shape (k,)
        Up to which each w^2 counts as none.
    """

    squares: np.ndarray
    shapes: np.ndarray
    none: np.ndarray

    @property
    def unstable(self) -> np.ndarray:
        """The most unstable motion as the only column, shape (n_u, 1); (n_u, 0) where all are stable."""
        found = np.flatnonzero(self.squares < -self.none)
        return self.shapes[:, found[np.argsort(self.squares[found])][:1]]

    @property
    def free(self) -> np.ndarray:
        """Motions that nothing holds, in columns."""
        return self.shapes[:, np.abs(self.squares) <= self.none]


def lowest(stiffness: csc_array, jacobian: csc_array, mass: np.ndarray, scale: np.ndarray, left: np.ndarray) -> Lowest:
    """The lowest w^2 of an equilibrium.

    Parameters
    ----------
    stiffness : sparse array, shape (n_u, n_u)
        K: how forces, with the reactions, fall with moves.
    jacobian : sparse array, shape (n_c, n_u)
        J of equations that do not depend on each other.
    mass : ndarray, shape (n_u,)
        The diagonal of M.
    scale : ndarray, shape (n_u,)
        What moves are measured by.
    left : ndarray, shape (n_u,)
        What is left of the forces.
    """
    if len(mass) <= MOST_DENSE:
        squares, shapes = _all(stiffness, jacobian, mass, scale)
        of_eigenvalues = STIFFNESS_ROUNDING * len(mass) * float(np.max(np.abs(squares), initial=0.0))
    else:
        squares, shapes = _near(stiffness, jacobian, mass, scale)
        of_eigenvalues = 0.0
    inertia = np.sum(shapes * (mass[:, None] * shapes), axis=0)
    sizes = np.abs(shapes)
    rounding = STIFFNESS_ROUNDING * np.sum(sizes * (abs(stiffness) @ sizes), axis=0)
    beside = BESIDE_IMBALANCE * (np.abs(left) / scale) @ sizes**2
    none = (rounding + beside) / np.where(inertia > 0, inertia, np.inf) + of_eigenvalues
    real = np.abs(squares.imag) <= 1e-6 * np.abs(squares) + none
    return Lowest(squares[real].real, shapes[:, real], none[real])


def _all(
    stiffness: csc_array, jacobian: csc_array, mass: np.ndarray, scale: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    free = null_space(jacobian.toarray() * scale) * scale[:, None]
    if not free.shape[1]:
        return np.zeros(0, dtype=complex), np.zeros((len(mass), 0))
    values, vectors = np.linalg.eig(np.linalg.solve(free.T @ (mass[:, None] * free), free.T @ (stiffness @ free)))
    return values, _real_shapes(values, free @ vectors)


def _real_shapes(values: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Real motions that span the same: real and imaginary part of a pair, as rounding makes of a double root."""
    return np.where(values.imag < 0.0, shapes.imag, shapes.real)


def _near(
    stiffness: csc_array, jacobian: csc_array, mass: np.ndarray, scale: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Negative w^2, and those next to zero, by shifts below zero, a decade apart: a negative one has a shift that is nearer to
    it than to any that is not.

    Shift-invert Arnoldi iteration (Lehoucq, Sorensen, Yang, ARPACK Users' Guide, SIAM 1998) on the sparse equations.
    """
    n, rows = len(mass), jacobian.shape[0]
    largest = float(np.max(abs(stiffness) @ scale / (mass * scale), initial=0.0))
    values, vectors = [np.zeros(0, dtype=complex)], [np.zeros((n, 0))]
    start = np.cos(np.arange(1, n + 1, dtype=float) ** 2)
    last = max(LEAST_SHIFT * largest, np.finfo(float).tiny)
    for shift in last * 10.0 ** np.arange(max(np.log10(max(largest, last) / last), 0) + 1):
        whole = block_array(
            [[stiffness + shift * diags_array(mass), jacobian.T], [jacobian, csc_array((rows, rows))]], format="csc"
        )
        try:
            of_inverse, shapes = _largest_of_inverse(whole, mass, MOST_FREE if shift == last else 1, start)
        except RuntimeError:  # exactly singular
            continue
        found = 1.0 / of_inverse - shift
        kept = (found.real < -OWN * shift) | (shift == last)
        values.append(found[kept])
        vectors.append(_real_shapes(found[kept], shapes[:, kept]))
    return np.concatenate(values), np.hstack(vectors)


def _largest_of_inverse(
    whole: csc_array, mass: np.ndarray, count: int, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of the largest size of x -> (K + s M)^-1 M x on the constraints; those that were found."""
    n, rows = len(mass), whole.shape[0] - len(mass)
    solve = splu(whole).solve
    operator = LinearOperator((n, n), lambda x: solve(np.append(mass * x, np.zeros(rows)))[:n], dtype=float)
    try:
        found: tuple[np.ndarray, np.ndarray] = eigs(operator, k=count, v0=start, tol=ACCURACY, maxiter=MOST_RESTARTS)
    except ArpackNoConvergence as some:
        return some.eigenvalues, some.eigenvectors
    return found
