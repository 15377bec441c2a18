"""Memory of the convergence test of Newton's iteration (`stiffmbs.solve.ida.native.iteration`)."""

from __future__ import annotations

import numpy as np

from ...compile.machine.layout import fill
from ...compile.machine.routines import Routine
from .native.layouts import ITERATION
from .session import Session

CONVERGED = Routine(
    "stiffmbs.solve.ida.native.iteration", "converged", "int32(int64, int64, int64, float64, int64, int64*)"
)


class Iteration:
    """Newton solver of IDA with a convergence test that considers the age of the iteration matrix.

    Parameters
    ----------
    n : int
        Number of unknowns.
    by_reactions : bool
        If True, forces depend on reactions, by laws that may have a kink where a reaction vanishes.

    Attributes
    ----------
    table : ndarray of int
        Table for compiled code (`stiffmbs.solve.ida.native.layouts.ITERATION`).
    """

    def __init__(self, n: int, by_reactions: bool) -> None:
        self._n, self._by_reactions = n, by_reactions
        self.table = np.zeros(len(ITERATION), dtype=np.int64)
        self._cells = self.table.view(ITERATION.cells)[0]
        self._cells["cj"] = np.inf

    def solver(self, session: Session, memory: int, y_vector: int) -> int:
        """Create the solver; IDA sets its own test when the solver is attached, so `take_over` must follow."""
        libraries = session.libraries
        made = libraries.SUNNonlinSol_Newton(y_vector, session.context)
        fill(
            self.table,
            ITERATION,
            {
                "n": self._n, "by_reactions": int(self._by_reactions), "memory": memory,
                "array_of": libraries.address("N_VGetArrayPointer"), "cj_of": libraries.address("IDAGetCurrentCj"),
                "iteration_of": libraries.address("SUNNonlinSolGetCurIter"),
            },
        )  # fmt: skip
        return session.keep(made, libraries.SUNNonlinSolFree, "a nonlinear solver")

    def begin(self) -> None:
        """Forget measured rates and the last step before a start or restart of the integrator."""
        self._cells["cj"], self._cells["growth"] = np.inf, -1.0

    def take_over(self, session: Session, solver: int) -> None:
        """Install the convergence test."""
        session.libraries.SUNNonlinSolSetConvTestFn(solver, CONVERGED.address, self.table.ctypes.data)
