"""Convergence test of Newton's iteration and norm of IDA's error test, for compiled code."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...compile.machine.layout import Table, fill
from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import Routine
from ..linear_solvers.linear_solver import Assembled
from .native.layouts import ERROR_NORM, ITERATION
from .operations import take_norm
from .session import Session

if TYPE_CHECKING:
    from .ida import NativeIda

NORM = Routine("stiffmbs.solve.ida.native.error_norm", "error_norm", "float64(int64*, int64)")
PART_BEFORE_EVENT = Routine(
    "stiffmbs.solve.ida.native.over_event", "part_before_event", "float64(int64, int64, int64*)", level=SHORT
)


class ErrorNorm:
    """Norm of error estimates without the components that strong damping removes within the step.

    `n`: number of unknowns. `table`: table for compiled code (`stiffmbs.solve.ida.native.layouts.ERROR_NORM`).
    """

    def __init__(self, n: int) -> None:
        self.table = Table(ERROR_NORM)
        self._cells = self.table.view(ERROR_NORM.cells)[0]
        self.forget()
        self._change, self._filtered = np.zeros(n), np.zeros(n)

    def take_place(self, ida: NativeIda, session: Session, assembled: Assembled) -> None:
        """Replace the norm of IDA's vectors, which are cloned from y. `assembled`: iteration matrix of IDA and its solver."""
        libraries = session.libraries
        functions = {
            "norm": "N_VWrmsNorm_Serial", "array_of": "N_VGetArrayPointer", "solve": "SUNLinSolSolve",
            "steps_of": "IDAGetNumSteps", "failures_of": "IDAGetNumErrTestFails", "order_of": "IDAGetLastOrder",
            "set_growth": "IDASetEtaFixedStepBounds", "set_largest_part": "IDASetEtaLow", "set_least_part": "IDASetEtaMinErrFail",
            "time_of": "IDAGetCurrentTime",
        }  # fmt: skip
        fill(
            self.table,
            {
                "memory": ida.memory, **{name: libraries.address(function) for name, function in functions.items()},
                "iteration": ida.iteration.table, "state": ida.state_table, "equations": ida.equations_table,
                "solver": assembled.solver, "matrix": assembled.matrix,
                "at_change": session.vector(self._change), "change": self._change,
                "at_filtered": session.vector(self._filtered), "filtered": self._filtered,
                "ida": ida.table, "part_before_event": PART_BEFORE_EVENT.address if ida.watch.n_event_functions else 0,
            },
        )  # fmt: skip
        take_norm(session, ida.y_vector, NORM.address, self.table)

    def filter_always(self, asked: bool) -> None:
        """Filter all error estimates, or only those after many failed error tests."""
        self._cells["always"] = asked

    def forget(self) -> None:
        """Forget failures of an earlier run."""
        for cell in self._cells.dtype.names:
            self._cells[cell] = 0
        self._cells["repeats"], self._cells["attempted"], self._cells["begun"] = 1.0, np.nan, np.nan


CONVERGED = Routine(
    "stiffmbs.solve.ida.native.iteration", "converged", "int32(int64, int64, int64, float64, int64, int64*)"
)


class Iteration:
    """Newton solver of IDA with a convergence test that considers the age of the iteration matrix.

    `n`: number of unknowns. `has_kinks`: True if forces may have kinks, where an event function or a reaction vanishes.
    `table`: table for compiled code (`stiffmbs.solve.ida.native.layouts.ITERATION`).
    """

    def __init__(self, n: int, has_kinks: bool) -> None:
        self._n, self._has_kinks = n, has_kinks
        self.table = Table(ITERATION)
        self._cells = self.table.view(ITERATION.cells)[0]
        self._cells["cj"] = np.inf

    def solver(self, ida: NativeIda, session: Session) -> int:
        """Create the solver; IDA sets its own test when the solver is attached, so `take_over` must follow."""
        libraries = session.libraries
        made = libraries.SUNNonlinSol_Newton(ida.y_vector, session.context)
        fill(
            self.table,
            {
                "n": self._n, "has_kinks": int(self._has_kinks), "memory": ida.memory,
                "array_of": libraries.address("N_VGetArrayPointer"), "cj_of": libraries.address("IDAGetCurrentCj"),
                "iteration_of": libraries.address("SUNNonlinSolGetCurIter"), "time_of": libraries.address("IDAGetCurrentTime"),
                "output_correction": ida.output_correction.table, "state": ida.state_table, "equations": ida.equations_table,
            },
        )  # fmt: skip
        return session.keep(made, libraries.SUNNonlinSolFree, "a nonlinear solver")

    def take_over(self, session: Session, solver: int) -> None:
        """Install the convergence test."""
        session.libraries.SUNNonlinSolSetConvTestFn(solver, CONVERGED.address, self.table.ctypes.data)
