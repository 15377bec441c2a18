"""Eigenvalues of a state matrix, with zero eigenvalues separated from small ones by the rank of the matrix.

Rigid body motions have double zeros, which rounding perturbs to the square root of its size. A basis of the null space
deflates them: with V = (V_1, V_2) and A V_1 = 0 all other eigenvalues are those of V_2^T A V_2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig, svd

from .parameters import LINEAR_ANALYSIS

ZERO_SINGULAR = 10 * np.finfo(float).eps
"""Singular value that counts as zero, relative to normalised rows, per row."""


@dataclass(frozen=True)
class Zeros:
    """Zero eigenvalues of a matrix.

    `eigenvectors` of shape (n, k): basis of its null space. `generalised` of shape (n, l): generalised eigenvectors.
    """

    eigenvectors: np.ndarray
    generalised: np.ndarray


def eigen(matrix: np.ndarray, n_poses: int, n_states: int = 0) -> tuple[np.ndarray, np.ndarray, Zeros]:
    """Return the nonzero eigenvalues, their eigenvectors as columns, and the zeros.

    `matrix` of shape (n, n). `n_poses`: rows of poses, followed by those of velocities, which are divided by the
    fastest rate. `n_states`: rows of states, which come last and are not scaled.
    """
    end = len(matrix) - n_states
    scale = np.ones(len(matrix))
    scale[n_poses:end] = _fastest_rate(matrix, n_poses, end) or 1.0
    values, vectors, levels = _deflated(matrix * scale / scale[:, None])
    values, vectors = _real_if_double(values, vectors)
    at_zero = [scale[:, None] * level for level in levels]
    nothing = np.zeros((len(matrix), 0))
    generalised = np.hstack([nothing, *at_zero[1:]])
    return values, scale[:, None] * vectors, Zeros(at_zero[0] if at_zero else nothing, generalised)


def _real_if_double(values: np.ndarray, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return eigenvalues and eigenvectors in which pairs with imaginary parts of the size of rounding are two real ones."""
    double = np.abs(values.imag) <= ZERO_SINGULAR * len(values) * np.abs(values)
    real = np.where(values.imag < 0.0, vectors.imag, vectors.real)
    return np.where(double, values.real, values), np.where(double, real, vectors)


def _fastest_rate(matrix: np.ndarray, n_poses: int, end: int) -> float:
    """Return the fastest rate of velocities due to poses, if it is not rounding next to those of damping and states, 1/s."""
    if n_poses == end:
        return 0.0
    velocities, states = slice(n_poses, end), slice(end, len(matrix))
    others = [np.linalg.norm(matrix[part, part], 2) for part in (velocities, states) if part.start < part.stop]
    return float(max(np.sqrt(np.linalg.norm(matrix[velocities, :n_poses], 2)), LINEAR_ANALYSIS.close * max(others)))


def is_singular(matrix: np.ndarray) -> bool:
    """Return True if a square matrix is numerically singular."""
    return not np.any(matrix) or bool(svd(_of_length_one(matrix), compute_uv=False)[-1] <= ZERO_SINGULAR * len(matrix))


def _of_length_one(matrix: np.ndarray) -> np.ndarray:
    """Return normalised rows; rows of the size of rounding become zero."""
    sizes = np.linalg.norm(matrix, axis=1)
    noise = ZERO_SINGULAR * len(matrix) * sizes.max()
    return np.asarray(matrix * np.where(sizes > noise, 1 / np.maximum(sizes, noise), 0.0)[:, None])


def _deflated(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Return nonzero eigenvalues, eigenvectors, and a basis of the generalised eigenvectors at zero for each order."""
    n = len(matrix)
    if not np.any(matrix):
        return np.zeros(0), np.zeros((n, 0)), [np.eye(n)] if n else []
    _, singular, basis = svd(_of_length_one(matrix))
    rank = int(np.sum(singular > ZERO_SINGULAR * n))
    if rank == n:
        values, vectors = eig(matrix)
        return values, vectors, []
    null, rest = basis[rank:].T, basis[:rank].T
    values, inner, levels = _deflated(rest.T @ matrix @ rest)
    vectors = rest @ inner + null @ (null.T @ matrix @ rest @ inner) / values
    return values, vectors, [null, *(rest @ level for level in levels)]
