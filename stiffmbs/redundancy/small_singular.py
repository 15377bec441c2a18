"""Singular values and left singular vectors of a matrix: all of a small matrix, else the small ones."""

from __future__ import annotations

import numpy as np

from .sparse_matrix import SparseMatrix

KNOWN_BY_SQUARES = 1e-3
"""Singular value below which eigenvalues of J J^T, accurate to 1e-8, are not used."""
WHOLE_UP_TO = 1000
"""Largest number of rows for which all singular values are computed."""
FEW = 3
"""Largest fraction of the rows, as its inverse, for which small singular values are computed alone."""
MORE, SHIFT, ITERATIONS = 10, 1e-10, 4
"""Additional vectors of the subspace, shift of J J^T, and iterations.

Each one reduces vectors of singular values above `KNOWN_BY_SQUARES` by SHIFT/KNOWN_BY_SQUARES^2.
"""


def small_singular(J: SparseMatrix) -> tuple[np.ndarray, np.ndarray]:
    """Return the singular values, shape (n,), in descending order, and left singular vectors of the last of them.

    For a large matrix, one of those above `KNOWN_BY_SQUARES` replaces all larger ones.

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
    """Compute all from eigenvalues of J J^T, which is faster than the decomposition of J.

    Small ones are recomputed by the decomposition of J^T on their eigenvectors.
    """
    squares, vectors = np.linalg.eigh(J @ J.T)
    count = int(np.sum(squares < KNOWN_BY_SQUARES**2))
    small = vectors[:, :count]
    _, values, turn = np.linalg.svd(J.T @ small, full_matrices=count > J.shape[1])
    values = np.pad(values, (0, count - len(values)))
    large = slice(None, count - 1 if count else None, -1)
    return np.concatenate([np.sqrt(squares[large]), values]), np.hstack([vectors[:, large], small @ turn.T])


def _by_iteration(J: SparseMatrix, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the small ones by subspace iteration (Bathe and Wilson, J. Eng. Mech. Div. 98, 1972) and J^T on it."""
    n = J.shape[0]
    vectors = np.random.default_rng(1).standard_normal((n, width))
    for _ in range(ITERATIONS):
        vectors, _ = np.linalg.qr(J.solved_gram(SHIFT, vectors))
    projected = J.transposed_times_all(vectors)
    _, values, turn = np.linalg.svd(projected, full_matrices=width > len(projected))
    values = np.pad(values, (0, width - len(values)))
    return np.concatenate([np.full(n - width, values[0]), values]), vectors @ turn.T
