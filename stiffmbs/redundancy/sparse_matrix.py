"""The matrices of loops by their entries, and what is asked of J J^T: dense where they are small, sparse where not."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

DENSE_UP_TO = 300
"""Rows up to which dense factors are made sooner than SciPy's sparse ones are imported."""


@dataclass(frozen=True)
class SparseMatrix:
    """A matrix by the entries that are not zero for its structure, each place once.

    Attributes
    ----------
    row, column : ndarrays of int
    value : ndarray
    shape : tuple of int
    """

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray
    shape: tuple[int, int]

    @property
    def finite(self) -> bool:
        """Whether all entries are finite numbers."""
        return bool(np.all(np.isfinite(self.value)))

    def dense(self) -> np.ndarray:
        """As a full matrix."""
        result = np.zeros(self.shape)
        result[self.row, self.column] = self.value
        return result

    def scaled(self, rows: np.ndarray, columns: np.ndarray) -> SparseMatrix:
        """Each row and each column multiplied by a factor."""
        with np.errstate(invalid="ignore"):  # where equations are not defined; the caller looks for finite numbers
            return replace(self, value=rows[self.row] * self.value * columns[self.column])

    def of_rows(self, kept: np.ndarray) -> SparseMatrix:
        """The rows that are marked."""
        inside = kept[self.row]
        number = np.cumsum(kept) - 1
        return SparseMatrix(
            number[self.row[inside]], self.column[inside], self.value[inside], (int(kept.sum()), self.shape[1])
        )

    def of_columns(self, kept: np.ndarray) -> SparseMatrix:
        """The matrix with zeros in the columns that are not marked."""
        inside = kept[self.column]
        return SparseMatrix(self.row[inside], self.column[inside], self.value[inside], self.shape)

    def norms(self) -> np.ndarray:
        """The length of each row."""
        return np.sqrt(np.bincount(self.row, self.value**2, self.shape[0]))

    def times(self, vector: np.ndarray) -> np.ndarray:
        """The product with a vector."""
        return np.bincount(self.row, self.value * vector[self.column], self.shape[0])

    def transposed_times(self, vector: np.ndarray) -> np.ndarray:
        """The product of the transpose with a vector."""
        return np.bincount(self.column, self.value * vector[self.row], self.shape[1])

    def transposed_times_all(self, vectors: np.ndarray) -> np.ndarray:
        """The products of the transpose with the columns of a matrix."""
        product: np.ndarray = self._sparse().T @ vectors
        return product

    def solved_gram(self, shift: float, right: np.ndarray) -> np.ndarray:
        """x of (A A^T + shift I) x = right, which may have several columns; the shift is greater than zero."""
        if self.shape[0] <= DENSE_UP_TO:
            return np.linalg.solve(self._dense_gram(shift), right)
        result: np.ndarray = _factors(self._sparse_gram(shift)).solve(right)
        return result

    def singular_values_above(self, least: float) -> bool:
        """Whether all of them are: A A^T - least^2 I is positive definite."""
        if self.shape[0] > self.shape[1]:
            return False
        if self.shape[0] <= DENSE_UP_TO:
            try:
                np.linalg.cholesky(self._dense_gram(-(least**2)))
            except np.linalg.LinAlgError:
                return False
            return True
        try:
            factors = _factors(self._sparse_gram(-(least**2)))
        except RuntimeError:  # SuperLU's word for a pivot that is zero
            return False
        # Pivots on the diagonal have the signs of the eigenvalues (Sylvester's law of inertia).
        return bool(np.array_equal(factors.perm_r, factors.perm_c) and np.all(factors.U.diagonal() > 0.0))

    def singular_values_below(self, bound: float) -> int | None:
        """How many there are; None where factors of A A^T - bound^2 I do not tell."""
        try:
            factors = _factors(self._sparse_gram(-(bound**2)))
        except RuntimeError:
            return None
        signs = factors.U.diagonal()
        told = np.array_equal(factors.perm_r, factors.perm_c) and np.all(np.isfinite(signs))
        return int(np.sum(signs < 0.0)) if told else None

    def _dense_gram(self, shift: float) -> np.ndarray:
        A = self.dense()
        gram = A @ A.T
        gram[np.diag_indices_from(gram)] += shift
        return gram

    def _sparse(self) -> Any:
        from scipy.sparse import csr_matrix

        return csr_matrix((self.value, (self.row, self.column)), shape=self.shape)

    def _sparse_gram(self, shift: float) -> Any:
        from scipy.sparse import identity

        A = self._sparse()
        return (A @ A.T + shift * identity(self.shape[0])).tocsc()


def _factors(gram: Any) -> Any:
    """SuperLU's factors of a symmetric matrix, with its pivots on the diagonal."""
    from scipy.sparse.linalg import splu

    return splu(gram, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
