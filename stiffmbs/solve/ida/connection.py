"""Integration formulas with the interface of IDA, and the functions that its loop calls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import Routine, together
from ..linear_solvers.linear_solver import Assembled
from .libraries import Libraries, ida_libraries
from .session import Session
from .statistics import COUNTERS

if TYPE_CHECKING:
    from .ida import NativeIda

MODULE = "stiffmbs.solve.ida.native.ida_loop"
RESIDUAL = Routine(MODULE, "residual", "int32(float64, int64, int64, int64, int64*)")
JACOBIAN = Routine(
    MODULE, "jacobian", "int32(float64, float64, int64, int64, int64, int64, int64*, int64, int64, int64)"
)
LOOK_AT_START, LOOK_WITHIN = together(
    "stiffmbs.solve.ida.native.ida_events",
    SHORT,
    look_at_start="int32(float64, float64, int64*)",
    look_within="int32(int64*)",
)

FUNCTIONS = {
    "array_of": "N_VGetArrayPointer", "solve": "IDASolve", "interpolate": "IDAGetDky", "time_of": "IDAGetCurrentTime",
    "order_of": "IDAGetLastOrder", "step_of": "IDAGetLastStep", "stop_at": "IDASetStopTime", "next_step_of": "IDAGetCurrentStep",
}  # fmt: skip
"""SUNDIALS functions called by compiled code, by their names in the table."""


class Formula(Protocol):
    """Integration formula with the interface of IDA: BDF by IDA itself, or Radau methods.

    `repeat`, `resolves`: addresses of functions by which a one-step method repeats its last step, and tells whether the
    error estimate of that step holds over jumps; 0 for a multistep method. A one-step method needs no small steps after a
    start, and its dense output satisfies the equations of stiff forces.
    """

    repeat: int
    resolves: int

    def libraries(self) -> Libraries:
        """Return the functions of SUNDIALS and those of the formula under the names of IDA's."""
        ...

    def memory(self, session: Session) -> int:
        """Return the address of the formula's memory."""
        ...

    def counters(self, memory: int, libraries: Libraries) -> np.ndarray:
        """Return the functions of the counters and their arguments, shape (2, counters)."""
        ...

    def connect(self, ida: NativeIda, session: Session, assembled: Assembled) -> None:
        """Prepare the memory for the driver's system and its iteration matrix."""
        ...

    def forget(self) -> None:
        """Discard results of an earlier run."""
        ...


class BDF:
    """BDF of variable order by IDA.

    `predicted_residual`: see `stiffmbs.solve.error_control.error_test.ErrorControl`.
    """

    repeat = resolves = 0

    def __init__(self, predicted_residual: bool = False) -> None:
        self._predicted_residual = predicted_residual

    def libraries(self) -> Libraries:
        """Return the libraries of IDA."""
        return ida_libraries()

    def memory(self, session: Session) -> int:
        """Return the address of IDA's memory in a session."""
        return session.ida()

    def counters(self, memory: int, libraries: Libraries) -> np.ndarray:
        """Return the functions of IDA's counters, and its memory as their argument, shape (2, counters)."""
        functions = [libraries.address(function) for function in COUNTERS.values()]
        return np.array([functions, [memory] * len(functions)])

    def connect(self, ida: NativeIda, session: Session, assembled: Assembled) -> None:
        """Give IDA the callbacks, the matrix, and the norm of error estimates."""
        residual, jacobian = RESIDUAL.address, JACOBIAN.address
        ida.error_norm.take_place(ida, session, assembled)
        ida.ask("IDAInit", residual, 0.0, ida.y_vector, ida.yp_vector)
        ida.ask("IDASetUserData", ida.table)
        ida.ask("IDASetLinearSolver", assembled.solver, assembled.matrix)
        ida.ask("IDASetJacFn", jacobian)
        ida.ask("IDASetMaxNumSteps", -1)  # IDASolve is called for one step at a time
        if self._predicted_residual:
            solver = ida.iteration.solver(ida, session)
            ida.ask("IDASetNonlinearSolver", solver)
            ida.iteration.take_over(session, solver)

    def forget(self) -> None:
        """Do nothing: IDA forgets at its next start."""
