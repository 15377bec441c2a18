"""Iteration matrices and the linear solvers that go with them: dense, banded, sparse."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from .libraries import COMPRESSED_COLUMNS, Libraries, ida_libraries, sparse_libraries
from .session import Session


class Assembled(NamedTuple):
    """A matrix in SUNDIALS and how to fill it.

    Attributes
    ----------
    matrix, solver : int
        The SUNMatrix and its SUNLinearSolver.
    values : int
        Address of the matrix' values.
    slots : ndarray of int or None
        Where each entry of the pattern stands in them; None for the pattern's own order.
    pattern : ndarray of int
        Address in the matrix, address of what is to be written there, and bytes, for each of the two index arrays:
        IDA clears them together with the values before each new matrix.
    kept : tuple
        What must live as long.
    pivots : numpy.void or None
        Cells of a linear solver that keeps its pivots: "ready" is zero where it has to find them anew; None where it always does.
    """

    matrix: int
    solver: int
    values: int
    slots: np.ndarray | None
    pattern: np.ndarray
    kept: tuple[object, ...] = ()
    pivots: np.void | None = None


class Matrix(Protocol):
    """A way to store and factor the iteration matrix."""

    def libraries(self) -> Libraries:
        """The libraries that it needs."""
        ...

    def assembled(self, session: Session, y: int) -> Assembled:
        """The matrix and its linear solver for vectors like `y`."""
        ...

    def sentence(self) -> str:
        """What it is, for a summary."""
        ...


class Dense(NamedTuple):
    """All entries, column after column; Gaussian elimination with partial pivoting."""

    n: int
    rows: np.ndarray
    columns: np.ndarray

    def libraries(self) -> Libraries:
        return ida_libraries()

    def sentence(self) -> str:
        return f"dense, {self.n} unknowns"

    def assembled(self, session: Session, y: int) -> Assembled:
        """A SUNDenseMatrix with SUNLinSol_Dense."""
        s = session.libraries
        matrix = session.keep(s.SUNDenseMatrix(self.n, self.n, session.context), s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_Dense(y, matrix, session.context), s.SUNLinSolFree, "a linear solver")
        return Assembled(
            matrix, solver, s.SUNDenseMatrix_Data(matrix), self.columns * self.n + self.rows, _no_pattern()
        )


class Banded(NamedTuple):
    """The diagonals near the main one; Gaussian elimination with partial pivoting within them."""

    n: int
    rows: np.ndarray
    columns: np.ndarray

    @property
    def upper(self) -> int:
        """Diagonals above the main one."""
        return max(0, int((self.columns - self.rows).max()))

    @property
    def lower(self) -> int:
        """Diagonals below the main one."""
        return max(0, int((self.rows - self.columns).max()))

    def libraries(self) -> Libraries:
        return ida_libraries()

    def sentence(self) -> str:
        return f"banded, {self.n} unknowns wide {self.lower + self.upper + 1}"

    def assembled(self, session: Session, y: int) -> Assembled:
        """A SUNBandMatrix with SUNLinSol_Band."""
        s = session.libraries
        made = s.SUNBandMatrix(self.n, self.upper, self.lower, session.context)
        matrix = session.keep(made, s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_Band(y, matrix, session.context), s.SUNLinSolFree, "a linear solver")
        height, diagonal = s.SUNBandMatrix_LDim(matrix), s.SUNBandMatrix_StoredUpperBandwidth(matrix)
        slots = self.columns * height + self.rows - self.columns + diagonal
        return Assembled(matrix, solver, s.SUNBandMatrix_Data(matrix), slots, _no_pattern())


class Sparse(NamedTuple):
    """The entries of the pattern, by columns; SuperLU_MT with one thread."""

    n: int
    rows: np.ndarray
    columns: np.ndarray

    def libraries(self) -> Libraries:
        return sparse_libraries()

    def sentence(self) -> str:
        return f"SuperLU_MT, {self.n} unknowns, {len(self.rows)} entries"

    def assembled(self, session: Session, y: int) -> Assembled:
        """A SUNSparseMatrix with SUNLinSol_SuperLUMT; its pattern is written anew with every matrix."""
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
