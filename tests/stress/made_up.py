"""A made-up problem of one unknown, y' = -y, whose parts can be made to fail: it shows every failure of IDA's."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from stiffmbs.solve.ida.libraries import Libraries
from stiffmbs.solve.ida.session import Session

NORMAL, ONE_STEP = 1, 2
COMPRESSED_COLUMNS = 0
"""CSC_MAT of sunmatrix_sparse.h."""
_ADDRESS, _REAL = ctypes.c_void_p, ctypes.c_double
RESIDUAL = ctypes.CFUNCTYPE(ctypes.c_int, _REAL, _ADDRESS, _ADDRESS, _ADDRESS, _ADDRESS)
JACOBIAN = ctypes.CFUNCTYPE(ctypes.c_int, _REAL, _REAL, *(8 * [_ADDRESS]))
ROOTS = ctypes.CFUNCTYPE(ctypes.c_int, _REAL, _ADDRESS, _ADDRESS, _ADDRESS, _ADDRESS)
SOLVE = ctypes.CFUNCTYPE(ctypes.c_int, _ADDRESS, _ADDRESS, _ADDRESS, _ADDRESS, _REAL)


class MadeUp:
    """IDA about to solve y' = rate(t, y) from y = 1.

    Parameters
    ----------
    libraries : Libraries
    rate : callable
        Of t and y.
    residual_flag, jacobian_flag, root_flag : callables
        Of t: what the callbacks return; 0 for success, above 0 for a failure that a smaller step may mend.
    slope : float
        dr/dy as the Jacobian claims it, for r = y' - rate.
    size : int
        Number of unknowns, all alike.
    """

    def __init__(
        self, libraries: Libraries, *, rate: Callable[[float, float], float] = lambda t, y: -y,
        residual_flag: Callable[[float], int] = lambda t: 0, jacobian_flag: Callable[[float], int] = lambda t: 0,
        root_flag: Callable[[float], int] = lambda t: 0, slope: float = 1.0, size: int = 1,
    ) -> None:  # fmt: skip
        self.libraries, self.session = libraries, Session(libraries)
        self._rate, self._flags, self._slope = rate, (residual_flag, jacobian_flag, root_flag), slope
        self.y, self.yp = np.ones(size), -np.ones(size)
        self.vectors = tuple(self.session.vector(values) for values in (self.y, self.yp))
        self.memory: int | None = self.session.ida()
        self.residual, self.jacobian, self.roots = (
            RESIDUAL(self._residual),
            JACOBIAN(self._jacobian),
            ROOTS(self._roots),
        )

    def _values(self, vector: int, count: int = 1) -> Any:
        return ctypes.cast(self.libraries.N_VGetArrayPointer(vector), ctypes.POINTER(_REAL * count)).contents

    def _residual(self, t: float, y: int, yp: int, r: int, _: int) -> int:
        self._values(r)[0] = self._values(yp)[0] - self._rate(t, self._values(y)[0])
        return self._flags[0](t)

    def _jacobian(self, t: float, cj: float, y: int, yp: int, r: int, matrix: int, *_: int) -> int:
        data = ctypes.cast(self.libraries.SUNDenseMatrix_Data(matrix), ctypes.POINTER(_REAL))
        data[0] = self._slope + cj
        return self._flags[1](t)

    def _roots(self, t: float, y: int, yp: int, values: int, _: int) -> int:
        ctypes.cast(values, ctypes.POINTER(_REAL))[0] = 1.0
        return self._flags[2](t)

    def call(self, function: str, *arguments: Any) -> int:
        """Call one of IDA's functions with the integrator's memory; its flag."""
        return self.function(function)(ctypes.c_void_p(self.memory), *arguments)

    def function(self, name: str) -> Any:
        """A function of SUNDIALS' that returns a flag; reals are passed as `ctypes.c_double`."""
        return next(library[name] for library in self.libraries.loaded if hasattr(library, name))

    def begin(self, rtol: float = 1e-6, atol: float = 1e-6, sparse: bool = False, roots: bool = False) -> int:
        """Give IDA what it needs (no Jacobian with a sparse matrix); the first flag below zero, or 0."""
        y, yp = (ctypes.c_void_p(vector) for vector in self.vectors)
        flag = self.call("IDAInit", self.residual, _REAL(0.0), y, yp) or self.call(
            "IDASStolerances", _REAL(rtol), _REAL(atol)
        )
        if flag < 0:
            return flag
        flag = self._with_sparse_matrix() if sparse else self._with_dense_matrix()
        if roots:
            flag = flag or self.call("IDARootInit", 1, self.roots)
        return flag

    def _with_dense_matrix(self) -> int:
        libraries, context = self.libraries, self.session.context
        matrix = self.session.keep(libraries.SUNDenseMatrix(1, 1, context), libraries.SUNMatDestroy, "a matrix")
        self.solver = self.session.keep(
            libraries.SUNLinSol_Dense(self.vectors[0], matrix, context), libraries.SUNLinSolFree, "a solver"
        )
        flag = self.call("IDASetLinearSolver", ctypes.c_void_p(self.solver), ctypes.c_void_p(matrix))
        return flag or self.call("IDASetJacFn", self.jacobian)

    def _with_sparse_matrix(self) -> int:
        """Give IDA a matrix whose derivatives it cannot find by differences."""
        flag, create = self._with_dense_matrix(), self.function("SUNSparseMatrix")
        create.restype, create.argtypes = _ADDRESS, [*3 * [ctypes.c_int64], ctypes.c_int, _ADDRESS]
        matrix = create(1, 1, 1, COMPRESSED_COLUMNS, self.session.context)
        matrix = self.session.keep(matrix, self.libraries.SUNMatDestroy, "a matrix")
        return flag or self.call("IDASetLinearSolver", _ADDRESS(self.solver), _ADDRESS(matrix))

    def solve(self, until: float = 10.0, task: int = NORMAL) -> int:
        """Integrate; IDA's flag."""
        reached = _REAL()
        y, yp = (ctypes.c_void_p(vector) for vector in self.vectors)
        return self.call("IDASolve", _REAL(until), ctypes.byref(reached), y, yp, task)

    def break_linear_solver(self) -> None:
        """Let its solve routine fail: the entry of its table that holds the dense one's address is replaced."""
        words = ctypes.cast(self.solver, ctypes.POINTER(_ADDRESS))
        wanted, self._broken = self.libraries.address("SUNLinSolSolve_Dense"), SOLVE(lambda *_: -1)
        for table in filter(None, words[1:4]):  # its place among the first moves between versions
            entries = ctypes.cast(table, ctypes.POINTER(_ADDRESS))
            for k in range(16):
                if entries[k] == wanted:
                    entries[k] = ctypes.cast(self._broken, _ADDRESS).value
