"""IDA memory with its vectors, matrix, callbacks and the table of their data."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compile.equations import Equations
from ...compile.machine.layout import packed
from ...compile.machine.routines import Routine, together
from ...compile.state import State
from ..dynamics import Dynamics
from ..events.event_functions import EventSearch
from ..events.long_steps import LongStepLog
from ..events.step_bound import StepBound
from ..native.tables.steps import ACCUMULATED_ERRORS, HISTORY_ROWS, LONG_STEPS, NATIVE_IDA, SAMPLES
from .error_norm import ErrorNorm
from .iteration import Iteration
from .matrices import Matrix
from .output_correction import OutputCorrection
from .session import Session
from .status import failure_sentence
from .step_log import StepLog

MODULE = "stiffmbs.solve.native.ida_loop"
RESIDUAL = Routine(MODULE, "residual", "int32(float64, int64, int64, int64, int64*)")
JACOBIAN = Routine(
    MODULE, "jacobian", "int32(float64, float64, int64, int64, int64, int64, int64*, int64, int64, int64)"
)
LOOK_AT_START, LOOK_WITHIN = together(
    "stiffmbs.solve.native.event_search.ida_events",
    look_at_start="int32(float64, float64, int64*)",
    look_within="int32(int64*)",
)
SWITCHES = Routine(MODULE, "event_functions", "int32(float64, int64, int64, float64*, int64*)")

FUNCTIONS = {
    "array_of": "N_VGetArrayPointer", "solve": "IDASolve", "interpolate": "IDAGetDky", "time_of": "IDAGetCurrentTime",
    "order_of": "IDAGetLastOrder", "step_of": "IDAGetLastStep", "stop_at": "IDASetStopTime", "next_step_of": "IDAGetCurrentStep",
    "errors_of": "IDAGetEstLocalErrors", "weights": "IDAGetErrWeights",
}  # fmt: skip
"""SUNDIALS functions called by compiled code, by their names in the table."""


class Connection:
    """IDA memory in SUNDIALS, with its data in the package.

    Parameters
    ----------
    equations : Equations
    state : State
    matrix : Matrix
    reported : ndarray of int
    session : Session
        Owner of the SUNDIALS objects.

    Attributes
    ----------
    y, yp, output : ndarrays, shape (n,)
        Memory of the vectors of the solution, of its derivative, and of interpolated or queried values.
    cells : numpy.void
        Results of the loop (`stiffmbs.solve.native.tables.steps.NATIVE_IDA`).
    output_correction : OutputCorrection
    iteration : Iteration
    error_norm : ErrorNorm
    step_bound : StepBound
    n_event_functions : int
    signs, masked : ndarrays, shape (n_event_functions,)
        See `stiffmbs.solve.native.event_search.event_signs`.
    watch : EventSearch
    history : StepLog
    long_steps : LongStepLog or None
        None for scenes without laws.
    furthest : ndarray
        Accumulated displacement error along each independent velocity.
    samples : ndarray, shape (SAMPLES, 1 + number of reported unknowns)
        Ring buffer of time and state after every fourth step; NaN in unused rows.
    table : int
        Address of the table for compiled code.
    """

    def __init__(
        self, equations: Equations, state: State, matrix: Matrix, reported: np.ndarray, session: Session
    ) -> None:
        n = equations.n
        self._session, self._state, self._equations = session, state, equations
        self.reported = np.ascontiguousarray(reported, dtype=np.int64)
        self.y, self.yp, self.output, self._probe = (np.zeros(n) for _ in range(4))
        self._residual = np.zeros(2 * n)
        self.history = StepLog()
        self.long_steps = LongStepLog(equations.system, len(self.reported)) if equations.system.has_laws else None
        self._long_steps = self.long_steps.table if self.long_steps else np.zeros(len(LONG_STEPS), dtype=np.int64)
        self.samples = np.full((SAMPLES, 1 + len(self.reported)), np.nan)
        self.y_vector, self.yp_vector, self.output_vector = map(session.vector, (self.y, self.yp, self.output))
        self.output_correction, self.step_bound = OutputCorrection(equations), StepBound()
        self.iteration = Iteration(n, bool(equations.system.forces_by_reactions))
        self._matrix, self._assembled = matrix, matrix.assembled(session, self.y_vector)
        self.memory = session.ida()
        self.watch = EventSearch(state)
        self.n_event_functions, self.masked = self.watch.n_event_functions, self.watch.masked
        self.signs = np.zeros(self.n_event_functions)
        self.error_norm = ErrorNorm(n)
        self._table = self._packed()
        self.table, self.cells = self._table.ctypes.data, self._table.view(NATIVE_IDA.cells)[0]
        tables = self._state_table, self._equations_table
        self.error_norm.take_place(session, self.memory, self.y_vector, tables, self._assembled, self.iteration.table)
        self._initialise()

    def _packed(self) -> np.ndarray:
        functions = {name: self._session.libraries.address(function) for name, function in FUNCTIONS.items()}
        history, formulation = self.history.rows(HISTORY_ROWS), self._equations.formulation
        for term_set in (formulation.residual_set, formulation.matrix_set):
            self._state.load(term_set)
        self._equations_table, self._slots = self._equations.table(self._assembled.slots)
        along = self._equations.along_motion
        self._sums = np.zeros((2, along.n + 1))
        self.furthest = self._sums[1]
        sums = {"n": along.n, "n_damped": along.n_damped, "displaced": self._sums[0], "furthest": self._sums[1]}
        self._errors = packed(ACCUMULATED_ERRORS, {**along.arrays, **sums})
        self._new_errors = self._errors.copy()
        self._state_table, self._calls = self._state.restricted(self._equations.used())
        return packed(
            NATIVE_IDA,
            {
                "state": self._state_table, "equations": self._equations_table,
                **functions,
                "matrix": self._assembled.values, "pattern": self._assembled.pattern,
                "n_event_functions": self.n_event_functions, "signs": self.signs, "masked": self.masked,
                "memory": self.memory, "y": self.y_vector, "yp": self.yp_vector,
                "at_output": self.output_vector, "output": self.output,
                "n_reported": len(self.reported), "reported": self.reported,
                "step_bound": self.step_bound.table, "history": history, "samples": self.samples,
                "output_correction": self.output_correction.table, "iteration": self.iteration.table, "watch": self.watch.table,
                "look_at_start": LOOK_AT_START.address if self.watch.n else 0, "look_within": LOOK_WITHIN.address if self.watch.n else 0,
                "probe": self._probe, "residual": self._residual, "long_steps": self._long_steps,
                "accumulated": self._errors, "error_norm": self.error_norm.table,
            },
        )  # fmt: skip

    def _initialise(self) -> None:
        self.ask("IDAInit", RESIDUAL.address, 0.0, self.y_vector, self.yp_vector)
        self.ask("IDASetUserData", self.table)
        self.ask("IDASetLinearSolver", self._assembled.solver, self._assembled.matrix)
        self.ask("IDASetJacFn", JACOBIAN.address)
        self.ask("IDASetMaxNumSteps", -1)  # IDASolve is called for one step at a time
        if self.n_event_functions:
            self.ask("IDARootInit", self.n_event_functions, SWITCHES.address)
            self.ask("IDASetNoInactiveRootWarn")

    def address(self, function: str) -> int:
        """Return the address of a SUNDIALS function, for compiled code."""
        return self._session.libraries.address(function)

    @property
    def on_one_thread(self) -> bool:
        """Return True if the linear solver never starts threads of its own."""
        return not self._session.libraries.may_start_threads

    def ask(self, function: str, *arguments: Any) -> None:
        """Call a function of IDA.

        Raises
        ------
        ValueError
            If IDA reports an error.
        """
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
        if self.long_steps:
            self.long_steps.forget()
        self._errors[:], self._sums[:] = self._new_errors, 0.0
        self.output_correction.forget()
        self.error_norm.forget()
        if self._assembled.pivots is not None:
            self._assembled.pivots["ready"] = 0

    def set_tolerances(self, rtol: float, atol: np.ndarray) -> None:
        """Set the relative tolerance, and the absolute tolerance of each unknown."""
        if np.shape(atol) != self.y.shape:
            raise ValueError(f"atol: found shape {np.shape(atol)}, expected {self.y.shape}")
        self._atol = np.array(atol, dtype=float)
        self.ask("IDASVtolerances", rtol, self._session.vector(self._atol))

    def begin(self, t: float) -> None:
        """Forget the last step before a start or restart of the integrator at `t`."""
        for cell, value in (("returned", t), ("internal", t), ("size", 0.0), ("tiny", 0), ("since_sample", 0)):
            self.cells[cell] = value
        self.samples[:] = np.nan
        self.signs[:] = 0.0
        self.watch.begin()
        self.iteration.begin()
        self.output_correction.begin()
        self.history.begin(t)

    def correct_outputs(self, dynamics: Dynamics, long_step: float, part: float, balanced: float) -> None:
        """Correct states within steps longer than `long_step` (see `OutputCorrection.limit`)."""
        if long_step < np.inf and not self.output_correction.ready:
            self.output_correction.make_ready(self._session, self._matrix, self.memory, self.y_vector, dynamics)
        self.output_correction.limit(long_step, part, balanced)

    def suppress(self, suppressed: np.ndarray) -> None:
        """Exclude unknowns from the error test."""
        self._id = np.where(suppressed, 0.0, 1.0)
        self.ask("IDASetId", self._session.vector(self._id))
        self.ask("IDASetSuppressAlg", 1)

    def take_own_convergence_test(self) -> None:
        """Use the convergence test of Newton's iteration that worsens the rate with the age of the iteration matrix."""
        solver = self.iteration.solver(self._session, self.memory, self.y_vector)
        self.ask("IDASetNonlinearSolver", solver)
        self.iteration.take_over(self._session, solver)

    def run(self, loop: Routine, *arguments: Any) -> int:
        """Call a compiled loop and add its steps to the history; return IDA's last flag."""
        flag: int = self._session.call(loop.call, *arguments, self.table)
        self.history.add(int(self.cells["recorded"]))
        return flag
