"""Native driver of IDA: compiled residual and Jacobian, compiled loop over the steps."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

import numpy as np

from ...compile.equations import Equations
from ...compile.inputs.features import InputFeatures
from ...compile.machine.layout import address, addresses
from ...compile.machine.routines import Routine
from ...compile.state import State
from ...describe.settings import RunSettings
from ..dynamics import Dynamics
from ..error_control.error_test import ErrorControl
from ..events.long_steps import LongStepLog
from ..native.statuses import ROOT_RETURN, STOP_RETURN
from ..native.tables.steps import MOST_STEPS
from .connection import MODULE, Connection
from .matrices import Matrix
from .session import Session
from .statistics import Statistics
from .status import Status, failure_sentence
from .step_log import StepLog

if TYPE_CHECKING:
    from .starting.anew import StartsAnew
    from .starting.starts import Starts

ADVANCE = Routine(MODULE, "advance", "int32(int64, float64*, float64, int64, float64*, int64, int64*)")
ADVANCE_PAST = Routine(
    "stiffmbs.solve.ida.native.passing",
    "advance_past",
    "int32(int64, float64*, int64, float64*, int64, int64, float64*, int64*, int64*)",
)
STEPS = Routine(MODULE, "steps", "int32(int64, float64, float64*, float64*, int64*)")

LONGEST_CALL, STEP_TIME = 0.1, 1e-7
"""Time, s, of a call, for progress and interruption; estimated time, s, of a step per unknown.  A clock would make
results depend on the load of the machine, because calls affect Newton's iteration."""


class NativeIda:
    """IDA memory of one formulation of one system, for any number of starts.

    Only one thread at a time may use an instance.  Several threads may use their own instances and states: the
    interpreter's lock is released while IDA works.

    Parameters
    ----------
    equations : Equations
    state : State
        Working memory of residual and Jacobian.
    matrix : Matrix
        Storage and factorisation of the iteration matrix (`stiffmbs.solve.ida.choice`).
    rtol : float
        Relative tolerance.
    atol : ndarray, shape (n,)
        Absolute tolerance of each unknown, greater than zero; a huge one excludes it from the error test and from
        Newton's convergence test.
    max_step : float
        Largest step, s; 0 for none.
    max_order : int
        Highest order of BDF, 1 to 5.
    suppressed : ndarray of bool, shape (n,), optional
        Unknowns excluded from the error test but not from Newton's convergence test (IDASetSuppressAlg).
    newton : float, optional
        Part of the error tolerance that Newton's iteration may leave (IDASetNonlinConvCoef); 0.33 by default.
    renewal : float, optional
        Relative change of cj that causes a linear solver setup (IDASetDeltaCjLSetup); 0.25 by default.
    growth : float
        Least factor by which a step is enlarged (IDASetEtaFixedStepBounds); IDA's own by default.
    predicted_residual : bool
        If True, the convergence rate of Newton's iteration worsens with the age of the iteration matrix
        (`stiffmbs.solve.native.iteration`).  IDA's own test keeps it until cj changes.
    reported : ndarray of int, optional
        Unknowns returned at output times; all by default.

    Attributes
    ----------
    y, yp : ndarrays, shape (n,)
        Solution at `t`, overwritten by every call.
    n_event_functions : int
        Number of event functions of the system; `advance` returns at their sign changes.
    matrix : Matrix
    connection : Connection
        Connection to IDA, for compiled code.

    Raises
    ------
    Unavailable
        If the SUNDIALS libraries cannot be used (`stiffmbs.solve.ida.libraries`).
    ValueError
        If IDA rejects a setting.

    References
    ----------
    Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363-396; user documentation of IDA 7.
    """

    def __init__(
        self,
        equations: Equations,
        state: State,
        matrix: Matrix,
        rtol: float,
        atol: np.ndarray,
        *,
        max_step: float = 0.0,
        max_order: int = 5,
        suppressed: np.ndarray | None = None,
        newton: float | None = None,
        renewal: float | None = None,
        growth: float = 2.0,
        predicted_residual: bool = False,
        reported: np.ndarray | None = None,
    ) -> None:
        n = equations.n
        self.matrix = matrix
        session = Session(self.matrix.libraries())
        self._finalizer = weakref.finalize(self, session.close)
        self.connection = self._ida = ida = Connection(
            equations, state, self.matrix, np.arange(n) if reported is None else reported, session
        )
        self.y, self.yp, self.n_event_functions = ida.y, ida.yp, ida.n_event_functions
        self._statistics = Statistics(session.libraries, ida.memory)
        self._flag, self._begun = 0, False
        self._pace = int(np.clip(LONGEST_CALL / (STEP_TIME * n), 1, MOST_STEPS))
        self._look = self._usual_pace = self._pace
        self._trace = np.empty((0, 2 + 2 * n))
        ida.set_tolerances(rtol, atol)
        self._tested = np.ones(n, dtype=bool) if suppressed is None else ~np.asarray(suppressed, dtype=bool)
        if suppressed is not None:
            ida.suppress(~self._tested)
        ida.ask("IDASetMaxStep", max_step)
        ida.ask("IDASetMaxOrd", max_order)
        if newton is not None:
            ida.ask("IDASetNonlinConvCoef", newton)
        if renewal is not None:
            ida.ask("IDASetDeltaCjLSetup", renewal)
        self._growth = growth
        if predicted_residual:
            ida.take_own_convergence_test()

    @property
    def begun(self) -> bool:
        """Return True if IDA was started since it was created or reset."""
        return self._begun

    @property
    def t(self) -> float:
        """Return the time of the solution in `y`, s."""
        return float(self._ida.cells["returned"])

    @property
    def history(self) -> StepLog:
        """Return the log of time, order and size of each step."""
        return self._ida.history

    @property
    def long_steps(self) -> LongStepLog | None:
        """Return the log of steps much longer than their predecessors; None for scenes without laws."""
        return self._ida.long_steps

    @property
    def furthest(self) -> np.ndarray:
        """Return the estimated accumulated displacement error along each independent velocity."""
        return self._ida.furthest

    @property
    def samples(self) -> np.ndarray:
        """Return time and reported unknowns after every fourth of the last 64 steps, in order of time."""
        newest = int(self._ida.cells["next_sample"])
        rows = np.concatenate([self._ida.samples[newest:], self._ida.samples[:newest]])
        return rows[~np.isnan(rows[:, 0])]

    def pause_after(self, steps: int) -> None:
        """Make `advance` and `steps` return after this number of steps at the latest."""
        self._pace = min(self._usual_pace, steps)

    def keep_steps(self, kept: bool) -> None:
        """Enable or disable storage of time, order, y and y' of each step for `kept_steps`."""
        width = 2 + 2 * len(self.y)
        self._trace = np.empty((MOST_STEPS if kept else 0, width))
        self._ida.cells["trace"] = self._trace.ctypes.data if kept else 0
        self._ida.cells["traced"] = 0

    def kept_steps(self) -> np.ndarray:
        """Return time, order, y and y' of the stored steps, one in each row, and clear them."""
        rows: np.ndarray = self._trace[: int(self._ida.cells["traced"])].copy()
        self._ida.cells["traced"] = 0
        return rows

    @property
    def may_pass(self) -> bool:
        """Return True if `advance_past` applies: no steps are stored, and states within long steps can be corrected."""
        return self._ida.output_correction.ready and not len(self._trace)

    def look_after(self, steps: int) -> None:
        """Make the next call of `advance` or `steps` return after this number of steps at the latest."""
        self._look = max(steps, 1)

    def leave_out(self, masked: np.ndarray) -> None:
        """Ignore each event function for a number of steps from the next start."""
        self._ida.masked[:] = masked

    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Resolve the features of inputs by sufficiently short steps."""
        self._ida.step_bound.follow(features)
        self._ida.watch.resolve(duration)

    def unresolved(self) -> str:
        """Return a sentence on periodic laws that steps do not resolve; empty if there are none."""
        return self._ida.watch.note()

    def leave_to_newton(self, part: float) -> None:
        """Set the part of the error tolerance that Newton's iteration may leave, as `newton` does."""
        self._ida.ask("IDASetNonlinConvCoef", part)

    def correct_outputs(self, dynamics: Dynamics, long_step: float, part: float, balanced: float) -> None:
        """Correct states within steps longer than `long_step`, s, up to a part of the error tolerance.

        States stay unchanged if the forces on each body balance up to the part `balanced` of the largest.  The same
        must hold after the `dynamics` of the same state has closed the joints.
        """
        self._ida.correct_outputs(dynamics, long_step, part, balanced)

    def filter_always(self, asked: bool) -> None:
        """Filter all error estimates (`stiffmbs.solve.native.error_norm`), or only those after many failures."""
        self._ida.error_norm.filter_always(asked)

    def forget(self) -> None:
        """Reset counters, history and pivots, as before the first start."""
        self._begun, self._look = False, self._usual_pace
        self._ida.ask("IDAReInit", 0.0, self._ida.y_vector, self._ida.yp_vector)  # resets IDA's counters
        self._statistics.forget()
        self._ida.forget()

    def begin(
        self, t: float, y: np.ndarray, yp: np.ndarray, first_step: float = 0.0, highest_order: int | None = None
    ) -> None:
        """Start or restart at consistent values.

        Parameters
        ----------
        t : float
        y, yp : ndarrays, shape (n,)
        first_step : float
            Size of the first step, s; 0 lets IDA choose it.
        highest_order : int, optional
            Highest order from here on; IDA cannot lower it within a run.
        """
        if self._begun:
            self._statistics.keep()
        self.y[:], self.yp[:] = y, yp
        self._ida.ask("IDAReInit", t, self._ida.y_vector, self._ida.yp_vector)
        self._ida.ask("IDASetInitStep", first_step)
        if highest_order is not None:
            self._ida.ask("IDASetMaxOrd", highest_order)
        self._ida.ask("IDASetEtaFixedStepBounds", 1.0, self._growth)
        self._ida.error_norm.begin(self._growth)
        self._ida.begin(t)
        self._begun, self._flag = True, 0

    def begun_at(self, t: float) -> None:
        """Note a start or restart by compiled code."""
        self.history.begin(t)
        self._begun, self._flag = True, 0

    def starts(
        self, dynamics: Dynamics, equations: Equations, settings: RunSettings, control: ErrorControl
    ) -> Starts | None:
        """Return compiled starts; None if they do not apply."""
        from .starting.starts import Starts

        if not Starts.serve(dynamics):
            return None
        return Starts(dynamics, equations, self.connection, self._statistics, settings, control)

    def advance(
        self, times: np.ndarray, stop: float, y_out: np.ndarray, yp_out: np.ndarray | None = None
    ) -> tuple[int, Status]:
        """Integrate towards `stop`, and report at output times.

        Returns early with `Status.GOING` after about 0.1 s of work: call it again with the remaining times.

        Parameters
        ----------
        times : ndarray
            Increasing output times, s, from `t` to `stop`.
        stop : float
            Time beyond which no residual is evaluated, s.
        y_out, yp_out : ndarrays, shape (len(times), number of reported unknowns)
            Output of the solution, and of its derivative.

        Returns
        -------
        served : int
            Number of output times reported.
        status : Status
        """
        times = np.ascontiguousarray(times, dtype=float)
        for rows in (y_out,) if yp_out is None else (y_out, yp_out):
            self._check_rows(rows, len(times))
        self._ida.ask("IDASetStopTime", stop)
        derivatives = 0 if yp_out is None else address(yp_out)
        self._run(ADVANCE, len(times), address(times), stop, min(self._pace, self._look), address(y_out), derivatives)
        return int(self._ida.cells["served"]), self._status()

    def advance_past(
        self, anew: StartsAnew, times: np.ndarray, stops: np.ndarray, highest_order: int, y_out: np.ndarray
    ) -> tuple[int, Status]:
        """Integrate as `advance` towards the first of some stops, and to later ones if `anew` can restart there."""
        times = np.ascontiguousarray(times, dtype=float)
        self._check_rows(y_out, len(times))
        most = min(self._pace, self._look)
        at_times, at_stops, at_rows = addresses(times, stops, y_out)
        self._run(ADVANCE_PAST, len(times), at_times, len(stops), at_stops, most, highest_order, at_rows, anew.table)
        return int(self._ida.cells["served"]), self._status()

    def steps(self, stop: float, t_out: np.ndarray, y_out: np.ndarray) -> tuple[int, Status]:
        """Integrate towards `stop` and report each step of IDA; return as `advance` does, or if `t_out` is full.

        Parameters
        ----------
        stop : float
        t_out : ndarray, shape (rows,)
        y_out : ndarray, shape (rows, number of reported unknowns)
        """
        self._check_rows(y_out, len(t_out))
        self._ida.ask("IDASetStopTime", stop)
        self._run(STEPS, min(self._pace, self._look, len(t_out)), stop, t_out.ctypes.data, y_out.ctypes.data)
        return int(self._ida.cells["served"]), self._status()

    def _check_rows(self, rows: np.ndarray, count: int) -> None:
        expected = (count, len(self._ida.reported))
        if rows.shape != expected or rows.dtype != np.float64 or not rows.flags.c_contiguous:
            raise ValueError(f"output rows: found {rows.dtype} of shape {rows.shape}, expected float64 of {expected}")

    def _run(self, loop: Routine, *arguments: Any) -> None:
        self._flag = self._ida.run(loop, *arguments)

    def _status(self) -> Status:
        if self._flag < 0:
            return Status.FAILED
        return {STOP_RETURN: Status.STOP, ROOT_RETURN: Status.ROOT}.get(self._flag, Status.GOING)

    def failure(self) -> str:
        """Return a sentence on the reason of the last failure."""
        return failure_sentence(self._flag)

    def roots(self) -> np.ndarray:
        """Return, after `Status.ROOT`, nonzero values for the event functions that have changed their signs.

        All are zero if the step has passed an interval of a law (`stiffmbs.solve.native.event_search.within_step`).
        """
        if self._ida.cells["within"]:
            return self._ida.watch.found[: self.n_event_functions].astype(np.intc)
        found = np.zeros(self.n_event_functions, dtype=np.intc)
        self._ida.ask("IDAGetRootInfo", address(found))
        return found * self._ida.signs.astype(np.intc)

    def interpolate(self, t: float, derivative: int = 0) -> np.ndarray:
        """Return the solution, or a derivative of it up to the last order, at a time within the last step.

        Raises
        ------
        ValueError
            If the time is outside the last step, or the derivative above its order.
        """
        return self._ida.answer("IDAGetDky", t, derivative)

    def counted(self) -> dict[str, int]:
        """Return the counters since the first start (`stiffmbs.solve.ida.statistics.COUNTERS`)."""
        return self._statistics.total()

    def statistics(self) -> dict[str, int]:
        """Return the counters since the first start, and the order of the last step."""
        return self._statistics.counted()

    def worst(self) -> tuple[int, float]:
        """Return the unknown with the largest estimated error in the last step, and that error in tolerances."""
        errors, weights = (self._ida.answer(name) for name in ("IDAGetEstLocalErrors", "IDAGetErrWeights"))
        weighted = np.abs(errors) * weights * self._tested
        k = int(np.argmax(weighted))
        return k, float(weighted[k])

    def close(self) -> None:
        """Free the SUNDIALS objects; automatic at the end of the instance, which cannot be used afterwards."""
        self._finalizer()
