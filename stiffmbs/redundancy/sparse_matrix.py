"""Sparse matrices of loops, and operations on J J^T: dense if small, else sparse."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..sparse.parameters import MATRICES

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import SuperLU


@dataclass(frozen=True)
class SparseMatrix:
    """Sparse matrix with unique places."""

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray
    shape: tuple[int, int]

    @property
    def is_small(self) -> bool:
        """True if dense factors are used."""
        return self.shape[0] <= MATRICES.dense_up_to

    @property
    def finite(self) -> bool:
        """True if all entries are finite."""
        return bool(np.all(np.isfinite(self.value)))

    def dense(self) -> np.ndarray:
        """Return the full matrix."""
        result = np.zeros(self.shape)
        result[self.row, self.column] = self.value
        return result

    def scaled(self, rows: np.ndarray, columns: np.ndarray) -> SparseMatrix:
        """Return the matrix with each row and each column multiplied by a factor."""
        with np.errstate(invalid="ignore"):  # equations may be undefined; the caller checks for finite numbers
            return replace(self, value=rows[self.row] * self.value * columns[self.column])

    def of_rows(self, kept: np.ndarray) -> SparseMatrix:
        """Return the marked rows."""
        inside = kept[self.row]
        number = np.cumsum(kept) - 1
        return SparseMatrix(
            number[self.row[inside]], self.column[inside], self.value[inside], (int(kept.sum()), self.shape[1])
        )

    def of_columns(self, kept: np.ndarray) -> SparseMatrix:
        """Return the matrix with zeros in the columns that are not marked."""
        inside = kept[self.column]
        return SparseMatrix(self.row[inside], self.column[inside], self.value[inside], self.shape)

    def norms(self) -> np.ndarray:
        """Return the norm of each row."""
        return np.sqrt(np.bincount(self.row, self.value**2, self.shape[0]))

    def times(self, vector: np.ndarray) -> np.ndarray:
        """Return the product with a vector."""
        return np.bincount(self.row, self.value * vector[self.column], self.shape[0])

    def transposed_times(self, vector: np.ndarray) -> np.ndarray:
        """Return the product of the transpose with a vector."""
        return np.bincount(self.column, self.value * vector[self.row], self.shape[1])

    def transposed_times_all(self, vectors: np.ndarray) -> np.ndarray:
        """Return the product of the transpose with a matrix."""
        product: np.ndarray = self._sparse().T @ vectors
        return product

    def solved_gram(self, shift: float, right: np.ndarray) -> np.ndarray:
        """Return x of (A A^T + shift I) x = right, with one or several columns; the shift is positive."""
        if self.is_small:
            return np.linalg.solve(self._dense_gram(shift), right)
        result: np.ndarray = _factors(self._sparse_gram(shift)).solve(right)
        return result

    def singular_values_above(self, least: float) -> bool:
        """Return True if all singular values exceed a bound: A A^T - least^2 I is positive definite."""
        if self.shape[0] > self.shape[1]:
            return False
        if self.is_small:
            try:
                np.linalg.cholesky(self._dense_gram(-(least**2)))
            except np.linalg.LinAlgError:
                return False
            return True
        try:
            factors = _factors(self._sparse_gram(-(least**2)))
        except RuntimeError:  # SuperLU's error for a zero pivot
            return False
        # Pivots on the diagonal have the signs of the eigenvalues (Sylvester's law of inertia).
        return bool(np.array_equal(factors.perm_r, factors.perm_c) and np.all(factors.U.diagonal() > 0.0))

    def singular_values_below(self, bound: float) -> int | None:
        """Return the number of singular values below a bound, or None if the factors do not determine it."""
        try:
            factors = _factors(self._sparse_gram(-(bound**2)))
        except RuntimeError:
            return None
        signs = factors.U.diagonal()
        is_known = np.array_equal(factors.perm_r, factors.perm_c) and np.all(np.isfinite(signs))
        return int(np.sum(signs < 0.0)) if is_known else None

    def _dense_gram(self, shift: float) -> np.ndarray:
        A = self.dense()
        gram = A @ A.T
        gram[np.diag_indices_from(gram)] += shift
        return gram

    def _sparse(self) -> csr_array:
        from scipy.sparse import csr_matrix

        return csr_matrix((self.value, (self.row, self.column)), shape=self.shape)

    def _sparse_gram(self, shift: float) -> csr_array:
        from scipy.sparse import identity

        A = self._sparse()
        return (A @ A.T + shift * identity(self.shape[0])).tocsc()


def _factors(gram: object) -> SuperLU:
    from scipy.sparse.linalg import splu

    return splu(gram, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
