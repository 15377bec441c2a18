"""Singular values and left singular vectors of a matrix: all of a small matrix, else the small ones."""

from __future__ import annotations

import numpy as np

from .sparse_matrix import SparseMatrix

CLEARLY_REGULAR = 1e-3
"""Singular value above which the singular vectors of a large matrix are not computed."""
MORE, SHIFT, ITERATIONS = 10, 1e-10, 4
"""Additional vectors of the subspace, shift of J J^T, and iterations.

Each one reduces vectors of singular values above `CLEARLY_REGULAR` by SHIFT/CLEARLY_REGULAR^2.
"""


def small_singular(J: SparseMatrix) -> tuple[np.ndarray, np.ndarray]:
    """Return the singular values, shape (n,), in descending order, and left singular vectors of the last of them.

    For a large matrix, one of those above `CLEARLY_REGULAR` replaces all larger ones.

    Parameters
    ----------
    J : SparseMatrix
        With n rows.
    """
    n = J.shape[0]
    count = None if J.is_small else J.singular_values_below(CLEARLY_REGULAR)
    if count is not None and count + MORE < n:
        return _by_iteration(J, count + MORE)
    vectors, values, _ = np.linalg.svd(J.dense(), full_matrices=n > J.shape[1])
    return np.pad(values, (0, n - len(values))), vectors


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
