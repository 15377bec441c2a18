"""Native driver of IDA: compiled residual and Jacobian, compiled loop over the steps."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

import numpy as np

from ...compile.equations import Equations
from ...compile.inputs.features import InputFeatures
from ...compile.machine.layout import address, addresses, packed
from ...compile.machine.native.statuses import ROOT_RETURN, STOP_RETURN
from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import Routine
from ...compile.state import State
from ...dynamics.dynamics import Dynamics
from ..events.event_functions import EventSearch, StepBound
from ..events.whole_steps import WholeStepLog
from ..linear_solvers.linear_solver import LinearSolver
from .connection import BDF, FUNCTIONS, LOOK_AT_START, LOOK_WITHIN, MODULE, Formula
from .error_norm import ErrorNorm, Iteration
from .native.layouts import NATIVE_IDA
from .native.parameters import LOOP
from .output_correction import OutputCorrection
from .session import Session
from .statistics import Statistics, Status, StepLog, failure_sentence

if TYPE_CHECKING:
    from .starts import Starts

ADVANCE = Routine(MODULE, "advance", "int32(int64, float64*, float64, int64, float64*, int64*)", level=SHORT)
ADVANCE_PAST = Routine(
    "stiffmbs.solve.ida.native.breakpoints",
    "advance_past",
    "int32(int64, float64*, int64, float64*, int64, int64, float64*, int64*, int64*)",
    level=SHORT,
)
STEPS = Routine(MODULE, "steps", "int32(int64, float64, float64*, float64*, int64*)")

AT_THE_END = np.empty(0)
"""No place within a step."""


class NativeIda:
    """IDA memory of one formulation of one system, for any number of starts.

    Only one thread at a time may use an instance.  Several threads may use their own instances and states: the
    interpreter's lock is released while IDA works.

    - `state`: working memory of residual and Jacobian.
    - `matrix`: storage and factorisation of the iteration matrix (`stiffmbs.solve.ida.choice`).
    - `rtol`, `atol` of shape (n,): relative tolerance, and absolute tolerance of each unknown, greater than zero; a huge
      one excludes it from the error test and from Newton's convergence test.
    - `max_step`: largest step, s; 0 for none.
    - `renewal`: relative change of cj that causes a linear solver setup (IDASetDeltaCjLSetup); that of the formula by default.
    - `formula`: BDF with IDA's own convergence test by default.
    - `reported`: unknowns returned at output times; all by default.
    - `y`, `yp` of shape (n,): solution at `t`, overwritten by every call. `output` of shape (n,): interpolated or queried values.
    - `cells`: results of the loop (`stiffmbs.solve.ida.native.layouts.NATIVE_IDA`).
    - `whole_steps`: steps that are checked after the run. `counters`: counters since the first start.
    - `words`, `table`: table for compiled code, and its address.
    - `state_table`, `equations_table`: tables of the state and of the equations.
    - `begun`: True if IDA was started since it was created or reset.

    Raises Unavailable if the SUNDIALS libraries cannot be used, and ValueError if IDA rejects a setting.

    References
    ----------
    Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363-396; user documentation of IDA 7.
    """

    def __init__(
        self,
        equations: Equations,
        state: State,
        matrix: LinearSolver,
        rtol: float,
        atol: np.ndarray,
        *,
        max_step: float = 0.0,
        renewal: float | None = None,
        formula: Formula | None = None,
        reported: np.ndarray | None = None,
    ) -> None:
        n, formula = equations.n, formula or BDF()
        if np.shape(atol) != (n,):
            raise ValueError(f"atol: found shape {np.shape(atol)}, expected {(n,)}")
        self._session = session = Session(formula.libraries())
        self._finalizer = weakref.finalize(self, session.close)
        self._state, self._equations, self._formula = state, equations, formula
        self.reported = np.ascontiguousarray(np.arange(n) if reported is None else reported, dtype=np.int64)
        self.y, self.yp, self.output, self._probe = (np.zeros(n) for _ in range(4))
        self._atol, self._residual = np.array(atol, dtype=float), np.zeros(2 * n)
        self.history, self.whole_steps = StepLog(), WholeStepLog(equations.system, len(self.reported))
        self._samples = np.full((LOOP.samples, 1 + len(self.reported)), np.nan)
        self.y_vector, self.yp_vector, self.output_vector = map(session.vector, (self.y, self.yp, self.output))
        self.output_correction, self._closing = OutputCorrection(equations), OutputCorrection(equations)
        self.step_bound = StepBound(bool(formula.repeat))
        self.watch = EventSearch(state)
        self._has_kinks = bool(equations.system.forces_by_reactions) or self.watch.n_event_functions > 0
        self.iteration, self.error_norm = Iteration(n, self._has_kinks), ErrorNorm(n)
        self._matrix, self._assembled = matrix, matrix.assembled(session, self.y_vector)
        self.memory = formula.memory(session)
        self.words = self._packed()
        self.table, self.cells = self.words.ctypes.data, self.words.view(NATIVE_IDA.cells)[0]
        formula.connect(self, session, self._assembled)
        self.counters = Statistics(session.libraries, self.memory, formula.counters(self.memory, session.libraries))
        self._flag, self.begun = 0, False
        self._batch = min(max(LOOP.most_items // n, 1), LOOP.most_steps)
        self._look = self._usual_batch = self._batch
        self._trace = np.empty((0, 2 + 2 * n))
        self.cells["rtol"] = rtol
        self.ask("IDASVtolerances", rtol, session.vector(self._atol))
        self.ask("IDASetMaxStep", max_step)
        if renewal is not None:
            self.ask("IDASetDeltaCjLSetup", renewal)

    def _packed(self) -> np.ndarray:
        functions = {name: self._session.libraries.address(function) for name, function in FUNCTIONS.items()}
        history, formulation = self.history.rows(2 * LOOP.most_steps), self._equations.formulation
        for term_set in (formulation.residual_set, formulation.matrix_set):
            self._state.load(term_set)
        self.equations_table, self._slots = self._equations.table()
        self.state_table = self._state.restricted(self._equations.used())
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
                "error_norm": self.error_norm.table, "closing": self._closing.table,
            },
        )  # fmt: skip

    @property
    def t(self) -> float:
        """Return the time of the solution in `y`, s."""
        return float(self.cells["returned"])

    @property
    def samples(self) -> np.ndarray:
        """Return time and reported unknowns after every fourth of the last 64 steps, in order of time."""
        newest = int(self.cells["next_sample"])
        rows = np.concatenate([self._samples[newest:], self._samples[:newest]])
        return rows[~np.isnan(rows[:, 0])]

    def pause_after(self, steps: int) -> None:
        """Make `advance` and `steps` return after this number of steps at the latest."""
        self._batch = min(self._usual_batch, steps)

    def keep_steps(self, kept: bool, places: np.ndarray = AT_THE_END) -> None:
        """Enable or disable storage of time, order, y and y' of each step for `kept_steps`, and of y at places within it."""
        width = 2 + 2 * len(self.y)
        self._trace = np.empty((LOOP.most_steps * (1 + len(places)) if kept else 0, width))
        self._places = np.array(places, dtype=float)
        self.cells["n_places"], self.cells["places"] = len(places), self._places.ctypes.data
        self.cells["trace"] = self._trace.ctypes.data if kept else 0
        self.cells["traced"] = 0

    def kept_steps(self) -> np.ndarray:
        """Return time, order, y and y' of the stored steps and their places, one in each row, and clear them."""
        rows: np.ndarray = self._trace[: int(self.cells["traced"])].copy()
        self.cells["traced"] = 0
        return rows

    @property
    def may_pass(self) -> bool:
        """Return True if `advance_past` applies: no steps are stored, and states within long steps can be corrected."""
        return self._polished and not len(self._trace)

    @property
    def usual_steps(self) -> int:
        """Return the number of steps after which a call returns that `pause_after` does not shorten."""
        return min(self._usual_batch, self._look)

    def look_after(self, steps: int) -> None:
        """Make the next call of `advance` or `steps` return after this number of steps at the latest."""
        self._look = max(steps, 1)

    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Resolve the features of inputs by sufficiently short steps."""
        self.step_bound.follow(features)
        self.watch.resolve(duration)

    def forget(self) -> None:
        """Reset counters, history and pivots, as before the first start."""
        self.begun, self._look, self.cells["next_size"] = False, self._usual_batch, 0.0
        self.ask("IDAReInit", 0.0, self.y_vector, self.yp_vector)  # resets IDA's counters
        self.counters.forget()
        corrections = self.output_correction, self._closing
        for each in (self.history, self.whole_steps, *corrections, self.error_norm, self._formula):
            each.forget()
        self._assembled.forget()

    def begun_at(self, t: float) -> None:
        """Note a start or restart by compiled code."""
        self.history.begin(t)
        self.begun, self._flag = True, 0

    def advance(self, times: np.ndarray, stop: float, y_out: np.ndarray) -> tuple[int, Status]:
        """Integrate towards `stop`, and report at output times.

        Returns early with `Status.GOING` after about 0.1 s of work: call it again with the remaining times. `times`:
        increasing output times, s, from `t` to `stop`. `stop`: time beyond which no residual is evaluated, s. `y_out`
        of shape (len(times), number of reported unknowns): output of the solution.
        Returns `served`: number of output times reported; `status`.
        """
        times = np.ascontiguousarray(times, dtype=float)
        self._check_rows(y_out, len(times))
        self.ask("IDASetStopTime", stop)
        self._flag = self.run(ADVANCE, len(times), address(times), stop, min(self._batch, self._look), address(y_out))
        return int(self.cells["served"]), self._status()

    def reported_at(self, t: float) -> np.ndarray:
        """Return the reported unknowns at a time within the last step, corrected as at output times.

        Raises ValueError if the time is outside the last step.
        """
        times, row, stop = np.array([t]), np.empty(len(self.reported)), float(self.cells["stopping"])
        no_steps = 0
        flag = self.run(ADVANCE, len(times), address(times), stop, no_steps, address(row))
        if flag < 0 or not self.cells["served"]:
            raise ValueError(failure_sentence(flag) if flag < 0 else f"found t = {t:.9g} s, after the last step")
        return row

    def advance_past(
        self, starts: Starts, times: np.ndarray, stops: np.ndarray, highest_order: int, y_out: np.ndarray
    ) -> tuple[int, Status]:
        """Integrate as `advance` towards the first of some stops, and to later ones if `starts` can restart there."""
        times = np.ascontiguousarray(times, dtype=float)
        self._check_rows(y_out, len(times))
        most = min(self._batch, self._look)
        at_times, at_stops, at_rows = addresses(times, stops, y_out)
        self._flag = self.run(
            ADVANCE_PAST, len(times), at_times, len(stops), at_stops, most, highest_order, at_rows, starts.table
        )
        return int(self.cells["served"]), self._status()

    def steps(self, stop: float, t_out: np.ndarray, y_out: np.ndarray) -> tuple[int, Status]:
        """Integrate towards `stop` and report each step of IDA; return as `advance` does, or if `t_out` is full.

        `t_out` of shape (rows,). `y_out` of shape (rows, number of reported unknowns).
        """
        self._check_rows(y_out, len(t_out))
        self.ask("IDASetStopTime", stop)
        self._flag = self.run(
            STEPS, min(self._batch, self._look, len(t_out)), stop, t_out.ctypes.data, y_out.ctypes.data
        )
        return int(self.cells["served"]), self._status()

    def _check_rows(self, rows: np.ndarray, count: int) -> None:
        expected = (count, len(self.reported))
        if rows.shape != expected or rows.dtype != np.float64 or not rows.flags.c_contiguous:
            raise ValueError(f"output rows: found {rows.dtype} of shape {rows.shape}, expected float64 of {expected}")

    def _status(self) -> Status:
        if self._flag < 0:
            return Status.FAILED
        return {STOP_RETURN: Status.STOP, ROOT_RETURN: Status.ROOT}.get(self._flag, Status.GOING)

    def failure(self) -> str:
        """Return a sentence on the reason of the last failure."""
        return failure_sentence(self._flag)

    def roots(self) -> np.ndarray:
        """Return, after `Status.ROOT`, 1 for the event functions that have changed their signs.

        All are zero if the step has passed an interval of a law (`stiffmbs.solve.events.native.within_step`).
        """
        return self.watch.found[: self.watch.n_event_functions].copy()

    def worst(self) -> tuple[int, float]:
        """Return the unknown with the largest estimated error in the last step, and that error in tolerances."""
        found = []
        for function in ("IDAGetEstLocalErrors", "IDAGetErrWeights"):
            self.ask(function, self.output_vector)
            found.append(self.output.copy())
        errors, weights = found
        weighted = np.multiply(np.abs(errors), weights, out=np.zeros_like(weights), where=weights > 0)
        k = int(np.argmax(weighted))
        return k, float(weighted[k])

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

    def correct_outputs(self, dynamics: Dynamics, may_stiffen: bool) -> None:
        """Correct states within long steps. `may_stiffen`: true if steps may be long for forces before the next start."""
        needed = may_stiffen or self._has_kinks
        for each in (self.output_correction, self._closing)[: 1 + bool(len(self._trace))]:
            if needed and not (self._formula.repeat or each.ready):
                each.make_ready(self, self._session, self._matrix, dynamics)

    def run(self, loop: Routine, *arguments: Any) -> int:
        """Call a compiled loop and add its steps to the history; return IDA's last flag."""
        flag: int = self._session.call(loop.call, *arguments, self.table)
        self.history.add(int(self.cells["recorded"]))
        return flag

    def close(self) -> None:
        """Free the SUNDIALS objects; automatic at the end of the instance, which cannot be used afterwards."""
        self._finalizer()
