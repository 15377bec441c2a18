"""Memory of an integrator with its vectors, matrix and the table of the loop's data."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from ...compile.equations import Equations
from ...compile.machine.layout import packed
from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import Routine, together
from ...compile.state import State
from ...dynamics.dynamics import Dynamics
from ..events.event_functions import EventSearch, StepBound
from ..events.whole_steps import WholeStepLog
from ..linear_solvers.fixed_order import Assembled, FixedOrder
from .error_norm import ErrorNorm, Iteration
from .libraries import Libraries, ida_libraries
from .native.layouts import NATIVE_IDA
from .native.parameters import LOOP
from .output_correction import OutputCorrection
from .session import Session
from .statistics import COUNTERS, StepLog, failure_sentence

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

PART_BEFORE_EVENT = Routine(
    "stiffmbs.solve.ida.native.over_event", "part_before_event", "float64(int64, int64, int64*)", level=SHORT
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

    @property
    def repeat(self) -> int:
        """See above."""
        ...

    @property
    def resolves(self) -> int:
        """See above."""
        ...

    def libraries(self) -> Libraries:
        """Return the functions of SUNDIALS and those of the formula under the names of IDA's."""
        ...

    def memory(self, session: Session) -> int:
        """Return the address of the formula's memory."""
        ...

    def counters(self, memory: int, libraries: Libraries) -> np.ndarray:
        """Return the functions of the counters and their arguments, shape (2, counters)."""
        ...

    def connect(self, connection: Connection, session: Session, assembled: Assembled) -> None:
        """Prepare the memory for the system of a connection and its iteration matrix."""
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

    def connect(self, connection: Connection, session: Session, assembled: Assembled) -> None:
        """Give IDA the callbacks, the matrix, and the norm of error estimates."""
        tables = connection.state_table, connection.equations_table
        iteration, residual, jacobian = connection.iteration, RESIDUAL.address, JACOBIAN.address
        connection.error_norm.take_place(
            session, connection.memory, connection.y_vector, tables, assembled, iteration.table, connection.table,
            PART_BEFORE_EVENT.address if connection.watch.n_event_functions else 0,
        )  # fmt: skip
        connection.ask("IDAInit", residual, 0.0, connection.y_vector, connection.yp_vector)
        connection.ask("IDASetUserData", connection.table)
        connection.ask("IDASetLinearSolver", assembled.solver, assembled.matrix)
        connection.ask("IDASetJacFn", jacobian)
        connection.ask("IDASetMaxNumSteps", -1)  # IDASolve is called for one step at a time
        if self._predicted_residual:
            of_prediction = {
                "output_correction": connection.output_correction.table,
                "state": tables[0],
                "equations": tables[1],
            }
            solver = iteration.solver(session, connection.memory, connection.y_vector, of_prediction)
            connection.ask("IDASetNonlinearSolver", solver)
            iteration.take_over(session, solver)

    def forget(self) -> None:
        """Do nothing: IDA forgets at its next start."""


class Connection:
    """Memory of an integrator, with its data in the package.

    `session`: owner of the SUNDIALS objects.

    - `y`, `yp`, `output` of shape (n,): memory of the vectors of the solution, of its derivative, and of interpolated
      or queried values.
    - `cells`: results of the loop (`stiffmbs.solve.ida.native.layouts.NATIVE_IDA`).
    - `whole_steps`: steps that are checked after the run.
    - `words`, `table`: table for compiled code, and its address.
    - `state_table`, `equations_table`: tables of the state and of the equations.
    """

    def __init__(
        self,
        equations: Equations,
        state: State,
        matrix: FixedOrder,
        reported: np.ndarray,
        session: Session,
        formula: Formula,
    ) -> None:
        n = equations.n
        self._session, self._state, self._equations, self._formula = session, state, equations, formula
        self.reported = np.ascontiguousarray(reported, dtype=np.int64)
        self.y, self.yp, self.output, self._probe, self._atol = (np.zeros(n) for _ in range(5))
        self._residual = np.zeros(2 * n)
        self.history = StepLog()
        self.whole_steps = WholeStepLog(equations.system, len(self.reported))
        self._samples = np.full((LOOP.samples, 1 + len(self.reported)), np.nan)
        self.y_vector, self.yp_vector, self.output_vector = map(session.vector, (self.y, self.yp, self.output))
        self.output_correction, self.step_bound = OutputCorrection(equations), StepBound(bool(formula.repeat))
        self.watch = EventSearch(state)
        self._has_kinks = bool(equations.system.forces_by_reactions) or self.watch.n_event_functions > 0
        self.iteration = Iteration(n, self._has_kinks)
        self.error_norm = ErrorNorm(n)
        self._matrix, self._assembled = matrix, matrix.assembled(session, self.y_vector)
        self.memory = formula.memory(session)
        self.words = self._packed()
        self.table, self.cells = self.words.ctypes.data, self.words.view(NATIVE_IDA.cells)[0]
        formula.connect(self, session, self._assembled)

    def _packed(self) -> np.ndarray:
        functions = {name: self._session.libraries.address(function) for name, function in FUNCTIONS.items()}
        history, formulation = self.history.rows(2 * LOOP.most_steps), self._equations.formulation
        for term_set in (formulation.residual_set, formulation.matrix_set):
            self._state.load(term_set)
        self.equations_table, self._slots = self._equations.table()
        self.state_table, self._calls = self._state.restricted(self._equations.used())
        return packed(
            NATIVE_IDA,
            {
                "state": self.state_table, "equations": self.equations_table,
                **functions,
                "matrix": self._assembled.values,
                "memory": self.memory, "repeat": self._formula.repeat, "resolves": self._formula.resolves, "y": self.y_vector, "yp": self.yp_vector,
                "at_output": self.output_vector, "output": self.output,
                "n_reported": len(self.reported), "reported": self.reported,
                "step_bound": self.step_bound.table, "history": history, "samples": self._samples,
                "output_correction": self.output_correction.table, "iteration": self.iteration.table, "watch": self.watch.table,
                "look_at_start": LOOK_AT_START.address if self.watch.n else 0, "look_within": LOOK_WITHIN.address if self.watch.n else 0,
                "probe": self._probe, "residual": self._residual, "atol": self._atol, "whole_steps": self.whole_steps.table,
                "error_norm": self.error_norm.table,
            },
        )  # fmt: skip

    @property
    def _polished(self) -> bool:
        return bool(self._formula.repeat) or self.output_correction.ready

    def address(self, function: str) -> int:
        """Return the address of a SUNDIALS function, for compiled code."""
        return self._session.libraries.address(function)

    def ask(self, function: str, *arguments: Any) -> None:
        """Call a function of IDA. Raises ValueError if IDA reports an error."""
        flag = getattr(self._session.libraries, function)(self.memory, *arguments)
        if flag < 0:
            raise ValueError(failure_sentence(flag))

    def answer(self, function: str, *arguments: Any) -> np.ndarray:
        """Call a function of IDA that fills a vector, and return a copy of it."""
        self.ask(function, *arguments, self.output_vector)
        return self.output.copy()

    def forget(self) -> None:
        """Clear the history, and the pivots of the linear solver."""
        self.history.forget()
        self.whole_steps.forget()
        self.output_correction.forget()
        self.error_norm.forget()
        self._formula.forget()
        if self._assembled.pivots is not None:
            self._assembled.pivots["ready"] = 0

    def _set_tolerances(self, rtol: float, atol: np.ndarray) -> None:
        if np.shape(atol) != self.y.shape:
            raise ValueError(f"atol: found shape {np.shape(atol)}, expected {self.y.shape}")
        self._atol[:] = atol
        self.cells["rtol"] = rtol
        self.ask("IDASVtolerances", rtol, self._session.vector(self._atol))

    def _forget_step(self, t: float) -> None:
        """Forget the last step before a start or restart of the integrator at `t`."""
        for cell, value in (("returned", t), ("internal", t), ("size", 0.0), ("tiny", 0), ("since_sample", 0)):
            self.cells[cell] = value
        self._samples[:] = np.nan
        self.watch.begin()
        self.iteration.begin()
        self.history.begin(t)

    def correct_outputs(self, dynamics: Dynamics, long_step: float, part: float, balanced: float) -> None:
        """Correct states within steps longer than `long_step` (see `OutputCorrection.limit`)."""
        needed = long_step < np.inf or self._has_kinks
        if needed and not (self._formula.repeat or self.output_correction.ready):
            self.output_correction.make_ready(self._session, self._matrix, self.memory, self.y_vector, dynamics)
        self.output_correction.limit(long_step, part, balanced)

    def run(self, loop: Routine, *arguments: Any) -> int:
        """Call a compiled loop and add its steps to the history; return IDA's last flag."""
        flag: int = self._session.call(loop.call, *arguments, self.table)
        self.history.add(int(self.cells["recorded"]))
        return flag
