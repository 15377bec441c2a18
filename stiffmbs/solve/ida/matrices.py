"""Iteration matrices with their linear solvers: dense, sparse."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from .libraries import COMPRESSED_COLUMNS, Libraries, ida_libraries, sparse_libraries
from .session import Session


class Assembled(NamedTuple):
    """SUNDIALS matrix and the data to fill it.

    - `matrix`, `solver`: the SUNMatrix and its SUNLinearSolver.
    - `values`: address of the values of the matrix.
    - `slots`: position of each entry of the pattern among the values; None for the order of the pattern.
    - `pattern`: address in the matrix, address of the data to be written there, and bytes, for both index arrays: IDA
      clears them with the values before each new matrix.
    - `kept`: objects that must stay alive.
    - `pivots`: cells of a linear solver that stores its pivots, with "ready" zero to search them again; None for
      others.
    """

    matrix: int
    solver: int
    values: int
    slots: np.ndarray | None
    pattern: np.ndarray
    kept: tuple[object, ...] = ()
    pivots: np.void | None = None


class Matrix(Protocol):
    """Storage and factorisation of the iteration matrix."""

    def libraries(self) -> Libraries:
        """Return the required libraries."""
        ...

    def assembled(self, session: Session, y: int) -> Assembled:
        """Create the matrix and its linear solver for vectors like `y`."""
        ...

    def sentence(self) -> str:
        """Return a description for the summary."""
        ...


class Dense(NamedTuple):
    """Dense matrix by columns; Gaussian elimination with partial pivoting."""

    n: int
    rows: np.ndarray
    columns: np.ndarray

    def libraries(self) -> Libraries:
        return ida_libraries()

    def sentence(self) -> str:
        return f"dense, {self.n} unknowns"

    def assembled(self, session: Session, y: int) -> Assembled:
        """Create a SUNDenseMatrix with SUNLinSol_Dense."""
        s = session.libraries
        matrix = session.keep(s.SUNDenseMatrix(self.n, self.n, session.context), s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_Dense(y, matrix, session.context), s.SUNLinSolFree, "a linear solver")
        return Assembled(
            matrix, solver, s.SUNDenseMatrix_Data(matrix), self.columns * self.n + self.rows, _no_pattern()
        )


class Sparse(NamedTuple):
    """Sparse matrix by columns; SuperLU_MT with one thread."""

    n: int
    rows: np.ndarray
    columns: np.ndarray

    def libraries(self) -> Libraries:
        return sparse_libraries()

    def sentence(self) -> str:
        return f"SuperLU_MT, {self.n} unknowns, {len(self.rows)} entries"

    def assembled(self, session: Session, y: int) -> Assembled:
        """Create a SUNSparseMatrix with SUNLinSol_SuperLUMT; its pattern is rewritten for every matrix."""
        s = session.libraries
        entries = len(self.rows)
        made = s.SUNSparseMatrix(self.n, self.n, entries, COMPRESSED_COLUMNS, session.context)
        matrix = session.keep(made, s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_SuperLUMT(y, matrix, 1, session.context), s.SUNLinSolFree, "a linear solver")
        rows = self.rows.astype(s.index_dtype)
        starts = np.searchsorted(self.columns, np.arange(self.n + 1)).astype(s.index_dtype)
        pattern = np.array(
            [
                s.SUNSparseMatrix_IndexValues(matrix), rows.ctypes.data, rows.nbytes,
                s.SUNSparseMatrix_IndexPointers(matrix), starts.ctypes.data, starts.nbytes,
            ], dtype=np.int64,
        )  # fmt: skip
        return Assembled(matrix, solver, s.SUNSparseMatrix_Data(matrix), None, pattern, (rows, starts))


def _no_pattern() -> np.ndarray:
    return np.zeros(6, dtype=np.int64)
