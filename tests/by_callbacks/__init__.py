"""Residual and iteration matrix of a formulation as functions of arrays, and IDA by scikit-sundae with them as callbacks."""

from __future__ import annotations

import numpy as np

from stiffmbs.compile.equations import Equations
from stiffmbs.compile.machine.routines import Routine
from stiffmbs.compile.state import State

_MODULE = "tests.by_callbacks.compiled"
RESIDUAL = Routine(_MODULE, "residual", "void(float64, float64*, float64*, float64*, int64*, int64*)")
JACOBIAN = Routine(_MODULE, "jacobian", "void(float64, float64*, float64*, float64, float64*, int64*, int64*)")


class Callbacks:
    """Residual and iteration matrix of equations, evaluated in the memory of a state."""

    def __init__(self, equations: Equations, state: State) -> None:
        state.load(equations.formulation.residual_set)
        state.load(equations.formulation.matrix_set)
        (table, slots), (rows, columns) = equations.table(), equations.pattern
        self._kept, self._tables = (state, table, slots), (state.table.ctypes.data, table.ctypes.data)
        self._rows, self._columns, self._entries = rows, columns, np.zeros(len(rows))

    def residual(self, t: float, y: np.ndarray, yp: np.ndarray, r: np.ndarray) -> None:
        """Compute r(t, y, y')."""
        RESIDUAL.call(t, y.ctypes.data, yp.ctypes.data, r.ctypes.data, *self._tables)

    def jacobian(self, t: float, y: np.ndarray, yp: np.ndarray, r: np.ndarray, cj: float, a: np.ndarray) -> None:
        """Compute dr/dy + cj dr/dy' as a full matrix."""
        JACOBIAN.call(t, y.ctypes.data, yp.ctypes.data, cj, self._entries.ctypes.data, *self._tables)
        a[...] = 0.0
        a[self._rows, self._columns] = self._entries


class ByScikitSundae:
    """IDA of scikit-sundae with a dense matrix, from consistent values; the reference of the package's own driver."""

    def __init__(self, equations: Equations, state: State, rtol: float, atol: np.ndarray) -> None:
        from sksundae.ida import IDA

        callbacks = Callbacks(equations, state)
        self._ida = IDA(callbacks.residual, jacfn=callbacks.jacobian, rtol=rtol, atol=atol, linsolver="dense")
        self.residuals = self.jacobians = 0

    def rows(self, y: np.ndarray, yp: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return the unknowns at times after zero, one row for each."""
        self._ida.init_step(0.0, y, yp)
        found = []
        for t in times:
            last = self._ida.step(t, method="normal", tstop=times[-1])
            found.append(last.y.copy())
        self.residuals, self.jacobians = last.nfev, last.njev
        return np.array(found)
