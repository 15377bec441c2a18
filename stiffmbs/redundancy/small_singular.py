"""The small singular values of a matrix and their left singular vectors: of all where it is small, else of these alone."""

from __future__ import annotations

import numpy as np

from .sparse_matrix import SparseMatrix

KNOWN_BY_SQUARES = 1e-3
"""Singular values below this are not taken from eigenvalues of J J^T, which know them to 1e-8 only."""
WHOLE_UP_TO = 1000
"""Rows up to which all singular values are computed."""
FEW = 3
"""Small singular values are sought alone where they are fewer than the rows divided by this."""
MORE, SHIFT, ITERATIONS = 10, 1e-10, 4
"""Vectors beside those sought, shift of J J^T, and iterations: each makes vectors of larger values than `KNOWN_BY_SQUARES` smaller by
SHIFT/KNOWN_BY_SQUARES^2 against those of zero."""


def small_singular(J: SparseMatrix) -> tuple[np.ndarray, np.ndarray]:
    """Singular values, shape (n,), the largest first, and the left singular vectors of the last of them.

    Of a large matrix, those above `KNOWN_BY_SQUARES` but for the last ones are not computed: one of these stands for them.

    Parameters
    ----------
    J : SparseMatrix
        With n rows.
    """
    n = J.shape[0]
    if n > WHOLE_UP_TO:
        count = J.singular_values_below(KNOWN_BY_SQUARES)
        if count is not None and FEW * (count + MORE) < n:
            return _by_iteration(J, count + MORE)
    return _of_all(J.dense())


def _of_all(J: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As eigenvalues of J J^T, which is some times faster than by the decomposition of J.

    Those too small to be told from rounding there are found anew by the decomposition of J^T on their eigenvectors alone.
    """
    squares, vectors = np.linalg.eigh(J @ J.T)
    count = int(np.sum(squares < KNOWN_BY_SQUARES**2))
    small = vectors[:, :count]
    _, values, turn = np.linalg.svd(J.T @ small, full_matrices=count > J.shape[1])
    values = np.pad(values, (0, count - len(values)))
    large = slice(None, count - 1 if count else None, -1)
    return np.concatenate([np.sqrt(squares[large]), values]), np.hstack([vectors[:, large], small @ turn.T])


def _by_iteration(J: SparseMatrix, width: int) -> tuple[np.ndarray, np.ndarray]:
    """By inverse iteration on a subspace (Bathe and Wilson, Large eigenvalue problems in dynamic analysis, J. Eng. Mech.
    Div. 98, 1972), and the decomposition of J^T on it."""
    n = J.shape[0]
    vectors = np.random.default_rng(1).standard_normal((n, width))
    for _ in range(ITERATIONS):
        vectors, _ = np.linalg.qr(J.solved_gram(SHIFT, vectors))
    projected = J.transposed_times_all(vectors)
    _, values, turn = np.linalg.svd(projected, full_matrices=width > len(projected))
    values = np.pad(values, (0, width - len(values)))
    return np.concatenate([np.full(n - width, values[0]), values]), vectors @ turn.T
