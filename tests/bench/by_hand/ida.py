"""IDA driven for equations written by hand: vectors, matrix, settings, and a loop over output times; nothing else."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stiffmbs.solve.ida.libraries import ida_libraries
from stiffmbs.solve.ida.session import Session

DATA = 1
"""Where the table of the callbacks (`tests.bench.by_hand.loop`) holds the address of the matrix."""
OUT_OF_THE_TEST = 1e15
"""Absolute tolerance of multipliers."""


@dataclass(frozen=True)
class Settings:
    """How IDA is set for a problem: the fastest that was found for an error of 1e-6.

    Attributes
    ----------
    newton : float
        Part of the tolerance that Newton's iteration may leave (IDASetNonlinConvCoef, 0.33 by default).
    renewal : float
        Change of cj from which the matrix is made anew (IDASetDeltaCjLSetup, 0.25 by default).
    suppressed : bool
        Whether IDASetSuppressAlg keeps multipliers out of the error test, in place of huge absolute tolerances.
    """

    newton: float = 0.33
    renewal: float = 0.25
    suppressed: bool = False


@dataclass(frozen=True)
class Equations:
    """SI2 of one problem, written by hand.

    Attributes
    ----------
    residual, jacobian : numba CFunc
        As IDA calls them; their user data is the table that `Run` lays out.
    y, yp : ndarrays, shape (n,)
        Consistent values at the start.
    positions, velocities : ndarrays of int
        Where q and u stand in y, in the order of the scene's bodies; the rest are multipliers.
    band : int
        Diagonals on either side of the main one; 0 for a dense matrix.
    numbers : ndarray
        Parameters of the equations.
    breakpoints : tuple of float
        Times at which the integrator starts anew, s.
    settings : Settings
    """

    residual: Any
    jacobian: Any
    y: np.ndarray
    yp: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    band: int = 0
    numbers: np.ndarray = field(default_factory=lambda: np.zeros(1))
    breakpoints: tuple[float, ...] = ()
    settings: Settings = field(default_factory=Settings)

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return len(self.y)

    def integrate(self, rtol: float, times: np.ndarray) -> np.ndarray:
        """Integrate from the first time to the last; rows of q and u at all times.

        Raises
        ------
        RuntimeError
            When IDA fails.
        """
        run = Run(self, rtol)
        try:
            return run.rows(times)
        finally:
            run.close()


class Run:
    """One integration: what SUNDIALS holds for it."""

    def __init__(self, equations: Equations, rtol: float) -> None:
        self._equations = equations
        self._session = session = Session(ida_libraries())
        self._y, self._yp = equations.y.copy(), equations.yp.copy()
        self._vectors = tuple(session.vector(values) for values in (self._y, self._yp))
        self._matrix, data, solver = self._storage()
        self._table = np.array(
            [session.libraries.address("N_VGetArrayPointer"), data, equations.numbers.ctypes.data, equations.n],
            dtype=np.int64,
        )
        self._memory = session.ida()
        self._ask("IDAInit", ctypes.cast(equations.residual.address, ctypes.c_void_p), 0.0, *self._vectors)
        self._ask("IDASetUserData", self._table.ctypes.data)
        self._ask("IDASetLinearSolver", solver, self._matrix)
        self._ask("IDASetJacFn", ctypes.cast(equations.jacobian.address, ctypes.c_void_p))
        self._ask("IDASetMaxNumSteps", -1)
        self._ask("IDASetNonlinConvCoef", equations.settings.newton)
        self._ask("IDASetDeltaCjLSetup", equations.settings.renewal)
        self._set_tolerances(rtol)

    def _ask(self, name: str, *arguments: Any) -> None:
        if getattr(self._session.libraries, name)(self._memory, *arguments) < 0:
            raise RuntimeError(f"{name} refused")

    def _storage(self) -> tuple[int, int, int]:
        """A SUNMatrix, the address of its values (of the first column's diagonal, if banded), and its linear solver."""
        session, n, band = self._session, self._equations.n, self._equations.band
        s = session.libraries
        if not band:
            matrix = session.keep(s.SUNDenseMatrix(n, n, session.context), s.SUNMatDestroy, "a matrix")
            solver = s.SUNLinSol_Dense(self._vectors[0], matrix, session.context)
            return matrix, s.SUNDenseMatrix_Data(matrix), session.keep(solver, s.SUNLinSolFree, "a linear solver")
        matrix = session.keep(s.SUNBandMatrix(n, band, band, session.context), s.SUNMatDestroy, "a matrix")
        solver = s.SUNLinSol_Band(self._vectors[0], matrix, session.context)
        diagonal = s.SUNBandMatrix_Data(matrix) + 8 * s.SUNBandMatrix_StoredUpperBandwidth(matrix)
        return matrix, diagonal, session.keep(solver, s.SUNLinSolFree, "a linear solver")

    def _set_tolerances(self, rtol: float) -> None:
        equations, tested = self._equations, np.zeros(self._equations.n)
        tested[equations.positions] = tested[equations.velocities] = 1.0
        suppressed = equations.settings.suppressed
        part = rtol if suppressed else rtol * np.sqrt(equations.n / tested.sum())
        self._atol = np.where((tested > 0) | suppressed, part, OUT_OF_THE_TEST)
        self._ask("IDASVtolerances", part, self._session.vector(self._atol))
        if suppressed:
            self._tested = tested
            self._ask("IDASetId", self._session.vector(self._tested))
            self._ask("IDASetSuppressAlg", 1)

    def residual(self, t: float, y: np.ndarray, yp: np.ndarray) -> np.ndarray:
        """The residual at given values."""
        found = np.empty(self._equations.n)
        vector = self._session.vector(found)
        self._y[:], self._yp[:] = y, yp
        self._equations.residual.ctypes(t, *self._vectors, vector, self._table.ctypes.data)
        return found

    def matrix(self, t: float, y: np.ndarray, yp: np.ndarray, cj: float) -> np.ndarray:
        """The iteration matrix at given values, full."""
        n, band = self._equations.n, self._equations.band
        height = self._session.libraries.SUNBandMatrix_LDim(self._matrix) if band else n
        first = int(self._table[DATA]) - 8 * (height - 1 - band if band else 0)
        values = np.ctypeslib.as_array((ctypes.c_double * (height * n)).from_address(first)).reshape(n, height)
        values[:] = 0.0
        self._y[:], self._yp[:] = y, yp
        self._equations.jacobian.ctypes(t, cj, *self._vectors, 0, 0, self._table.ctypes.data, 0, 0, 0)
        if not band:
            return values.T.copy()
        rows, columns = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
        inside = np.abs(rows - columns) <= band
        full = np.zeros((n, n))
        full[inside] = values[columns[inside], (height - 1 - band + rows - columns)[inside]]
        return full

    def rows(self, times: np.ndarray) -> np.ndarray:
        """q and u at all times, of which the first is the start."""
        equations = self._equations
        reported = np.concatenate([equations.positions, equations.velocities])
        rows = np.empty((len(times), len(reported)))
        rows[0] = equations.y[reported]
        address = self._session.libraries.address
        breakpoints = np.array([*equations.breakpoints, times[-1]])
        flag = _loop()(
            np.array([address("IDASolve"), address("IDASetStopTime"), address("IDAReInit"), self._memory]),
            *self._vectors, self._y, reported, times, breakpoints, rows,
        )  # fmt: skip
        if flag < 0:
            raise RuntimeError(f"IDA stopped with flag {flag}")
        return rows

    def steps(self) -> int:
        """Steps since the last breakpoint."""
        count = ctypes.c_long()
        self._ask("IDAGetNumSteps", ctypes.byref(count))
        return count.value

    def close(self) -> None:
        """Free what SUNDIALS holds."""
        self._session.close()


def at_rest(equations: Equations, lam: np.ndarray) -> Equations:
    """The equations with accelerations and multipliers of a start at rest, from [M J^T; J 0][u'; lam] = [f; 0].

    Parameters
    ----------
    equations : Equations
        Without damping; the row of each unknown has its number.
    lam : ndarray of int
        Where the multipliers are.
    """
    u = equations.velocities
    both = np.concatenate([u, lam])
    run = Run(equations, 1.0)
    f = -run.residual(0.0, equations.y, np.zeros(equations.n))[u]
    block = run.matrix(0.0, equations.y, np.zeros(equations.n), 1.0)[np.ix_(both, both)]
    run.close()
    found = np.linalg.solve(block, np.concatenate([f, np.zeros(len(lam))]))
    y, yp = equations.y.copy(), equations.yp.copy()
    yp[u], y[lam] = found[: len(u)], found[len(u) :]
    return replace(equations, y=y, yp=yp)


def _loop() -> Callable[..., int]:
    from .loop import loop

    return loop
