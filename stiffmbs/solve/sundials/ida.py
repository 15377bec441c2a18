"""IDA driven through its C interface: compiled residual and Jacobian, compiled loop over the steps."""

from __future__ import annotations

import time
import weakref
from typing import Any

import numpy as np

from ...compile.equations import Equations
from ...compile.layout import NATIVE_IDA, packed
from ...compile.routines import Routine
from ...compile.state import State
from .history import History
from .matrices import Matrix, chosen
from .session import Session
from .statistics import Statistics
from .status import Status, failure_sentence

_MODULE = "stiffmbs.solve.native.ida_loop"
RESIDUAL = Routine(_MODULE, "residual", "int32(float64, int64, int64, int64, int64*)")
JACOBIAN = Routine(
    _MODULE, "jacobian", "int32(float64, float64, int64, int64, int64, int64, int64*, int64, int64, int64)"
)
SWITCHES = Routine(_MODULE, "switches", "int32(float64, int64, int64, float64*, int64*)")
ADVANCE = Routine(_MODULE, "advance", "int32(int64, float64*, float64, int64, float64*, int64, int64*)")
STEPS = Routine(_MODULE, "steps", "int32(int64, float64, float64*, float64*, int64*)")

RETURNED, INTERNAL, SIZE = range(3)
SERVED, RECORDED, ORDER, TINY = range(4)
STOP_RETURN, ROOT_RETURN = 1, 2
"""As in `stiffmbs.solve.native.ida_loop`."""

LONGEST_CALL = 0.1
"""Time, s, after which a call returns, for progress and interruption."""
FIRST_CALL, MOST_STEPS = 64, 4096
"""Steps of the first call, before the time of a step is known, and of any call."""


class NativeIda:
    """IDA set up for one formulation of one system; begun as often as wanted.

    One thread at a time may use an instance; several threads may each use their own, with its own state: the
    interpreter's lock is released while IDA works.

    Parameters
    ----------
    equations : Equations
    state : State
        The working memory of residual and Jacobian.
    rtol : float
        Relative tolerance.
    atol : ndarray, shape (n,)
        Absolute tolerance of each unknown, greater than zero; a huge one takes it out of the error test and of
        Newton's convergence test.
    max_step : float
        Largest step, s; 0 for none.
    max_order : int
        Of the BDF formula, 1 to 5.
    suppressed : ndarray of bool, shape (n,), optional
        Unknowns that are left out of the error test but not of Newton's convergence test (IDASetSuppressAlg).
    newton : float, optional
        Part of the error tolerance that Newton's iteration may leave (IDASetNonlinConvCoef); 0.33 by default.
    reported : ndarray of int, optional
        The unknowns that are given at output times; all by default.
    matrix : Matrix, optional
        How the iteration matrix is stored and factored (`stiffmbs.solve.sundials.matrices`); by its pattern by default.

    Attributes
    ----------
    y, yp : ndarrays, shape (n,)
        The solution at `t`, overwritten by every call.
    n_switches : int
        Switches of the system; `advance` returns where one of them changes its sign.
    matrix : Matrix

    Raises
    ------
    Unavailable
        When SUNDIALS' libraries cannot be used (`stiffmbs.solve.sundials.libraries`).
    ValueError
        When IDA refuses a setting.

    References
    ----------
    Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363-396; user documentation of IDA 7.
    """

    def __init__(
        self,
        equations: Equations,
        state: State,
        rtol: float,
        atol: np.ndarray,
        *,
        max_step: float = 0.0,
        max_order: int = 5,
        suppressed: np.ndarray | None = None,
        newton: float | None = None,
        reported: np.ndarray | None = None,
        matrix: Matrix | None = None,
    ) -> None:
        n = equations.n
        self.matrix = matrix or chosen(n, *equations.pattern)
        self._session = Session(self.matrix.libraries())
        self._finalizer = weakref.finalize(self, self._session.close)
        self._state = state
        self.y, self.yp, self._output = np.zeros(n), np.zeros(n), np.zeros(n)
        self._reported = np.arange(n) if reported is None else np.ascontiguousarray(reported, dtype=np.int64)
        self._mark, self._count = np.zeros(3), np.zeros(4, dtype=np.int64)
        self.history = History()
        self._pace, self._flag, self._begun = FIRST_CALL, 0, False
        self._connect(equations)
        self._statistics = Statistics(self._session.libraries, self._memory)
        self._set_tolerances(rtol, atol, suppressed)
        self._set(max_step=max_step, max_order=max_order, newton=newton)

    def _connect(self, equations: Equations) -> None:
        """Make the objects of SUNDIALS and give them the compiled functions and their table."""
        session, s = self._session, self._session.libraries
        self._y, self._yp, self._at_output = (session.vector(v) for v in (self.y, self.yp, self._output))
        self._assembled = self.matrix.assembled(session, self._y)
        self._memory = session.ida()
        self._equations_table, self._slots = equations.table(self._assembled.slots)
        self.n_switches = equations.system.n_values("switch")
        for term_set in (equations.formulation.residual_set, equations.formulation.matrix_set):
            self._state.load(term_set)
        if self.n_switches:
            self._state.load("switch")
        self._table = packed(NATIVE_IDA, self._fields())
        self._must(s.IDAInit(self._memory, RESIDUAL.address(), 0.0, self._y, self._yp))
        self._must(s.IDASetUserData(self._memory, self._table.ctypes.data))
        self._must(s.IDASetLinearSolver(self._memory, self._assembled.solver, self._assembled.matrix))
        self._must(s.IDASetJacFn(self._memory, JACOBIAN.address()))
        if self.n_switches:
            self._must(s.IDARootInit(self._memory, self.n_switches, SWITCHES.address()))
            self._must(s.IDASetNoInactiveRootWarn(self._memory))

    def _fields(self) -> dict[str, Any]:
        s = self._session.libraries
        return {
            "state": self._state.table, "equations": self._equations_table, "array_of": s.address("N_VGetArrayPointer"),
            "matrix": self._assembled.values, "pattern": self._assembled.pattern,
            "n_switches": self.n_switches,
            "memory": self._memory, "y": self._y, "yp": self._yp, "at_output": self._at_output, "output": self._output,
            "n_reported": len(self._reported), "reported": self._reported,
            "solve": s.address("IDASolve"), "interpolate": s.address("IDAGetDky"),
            "time_of": s.address("IDAGetCurrentTime"), "order_of": s.address("IDAGetLastOrder"),
            "step_of": s.address("IDAGetLastStep"),
            "mark": self._mark, "count": self._count, "history": self.history.room(MOST_STEPS),
        }  # fmt: skip

    def _set_tolerances(self, rtol: float, atol: np.ndarray, suppressed: np.ndarray | None) -> None:
        s, n = self._session.libraries, len(self.y)
        if np.shape(atol) != (n,):
            raise ValueError(f"atol: found shape {np.shape(atol)}, expected ({n},)")
        self._atol = np.array(atol, dtype=float)
        self._must(s.IDASVtolerances(self._memory, rtol, self._session.vector(self._atol)))
        self._counts_in_error_test = np.ones(n)
        if suppressed is not None:
            self._counts_in_error_test[suppressed] = 0.0
            self._must(s.IDASetId(self._memory, self._session.vector(self._counts_in_error_test)))
            self._must(s.IDASetSuppressAlg(self._memory, 1))

    def _set(self, max_step: float, max_order: int, newton: float | None) -> None:
        s = self._session.libraries
        self._must(s.IDASetMaxStep(self._memory, max_step))
        self._must(s.IDASetMaxOrd(self._memory, max_order))
        self._must(s.IDASetMaxNumSteps(self._memory, -1))  # calls are of one step each
        if newton is not None:
            self._must(s.IDASetNonlinConvCoef(self._memory, newton))

    @staticmethod
    def _must(flag: int) -> None:
        if flag < 0:
            raise ValueError(failure_sentence(flag))

    @property
    def t(self) -> float:
        """Time of the solution in `y`, s."""
        return float(self._mark[RETURNED])

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, first_step: float = 0.0) -> None:
        """Start, or start again, from consistent values.

        Parameters
        ----------
        t : float
        y, yp : ndarrays, shape (n,)
        first_step : float
            Size of the first step, s; 0 lets IDA choose it.
        """
        s = self._session.libraries
        if self._begun:
            self._statistics.keep()
        self.y[:], self.yp[:] = y, yp
        self._must(s.IDAReInit(self._memory, t, self._y, self._yp))
        self._must(s.IDASetInitStep(self._memory, first_step))
        self._mark[[RETURNED, INTERNAL]] = t
        self._count[TINY] = 0
        self.history.begin(t)
        self._begun, self._flag = True, 0

    def advance(
        self, times: np.ndarray, stop: float, y_out: np.ndarray, yp_out: np.ndarray | None = None
    ) -> tuple[int, Status]:
        """Go on towards `stop`, and report at the output times on the way.

        Returns early, with `Status.GOING`, after about 0.1 s of work: call again with the times that are left.

        Parameters
        ----------
        times : ndarray
            Increasing, none behind `t` nor beyond `stop`.
        stop : float
            Time beyond which no residual is evaluated, s.
        y_out, yp_out : ndarrays, shape (len(times), number of reported unknowns)
            Receive the solution, and its derivative.

        Returns
        -------
        served : int
            Number of output times reported.
        status : Status
        """
        times = np.ascontiguousarray(times, dtype=float)
        for rows in (y_out,) if yp_out is None else (y_out, yp_out):
            self._check_rows(rows, len(times))
        self._stop_at(stop)
        derivatives = 0 if yp_out is None else yp_out.ctypes.data
        self._run(ADVANCE, len(times), times.ctypes.data, stop, self._pace, y_out.ctypes.data, derivatives)
        return int(self._count[SERVED]), self._status()

    def steps(self, stop: float, t_out: np.ndarray, y_out: np.ndarray) -> tuple[int, Status]:
        """Go on towards `stop` and report each of IDA's own steps; returns as `advance` does, or when `t_out` is full.

        Parameters
        ----------
        stop : float
        t_out : ndarray, shape (rows,)
        y_out : ndarray, shape (rows, number of reported unknowns)
        """
        self._check_rows(y_out, len(t_out))
        self._stop_at(stop)
        self._run(STEPS, min(self._pace, len(t_out)), stop, t_out.ctypes.data, y_out.ctypes.data)
        return int(self._count[SERVED]), self._status()

    def _check_rows(self, rows: np.ndarray, count: int) -> None:
        expected = (count, len(self._reported))
        if rows.shape != expected or rows.dtype != np.float64 or not rows.flags.c_contiguous:
            raise ValueError(f"output rows: found {rows.dtype} of shape {rows.shape}, expected float64 of {expected}")

    def _stop_at(self, stop: float) -> None:
        self._must(self._session.libraries.IDASetStopTime(self._memory, stop))

    def _run(self, loop: Routine, *arguments: Any) -> None:
        """Call a compiled loop; keep the history of the call, and set the number of steps of the next."""
        begun = time.perf_counter()
        with self._session.libraries.on_one_thread():
            self._flag = loop.load()(*arguments, self._table.ctypes.data)
        seconds = time.perf_counter() - begun
        self.history.add(int(self._count[RECORDED]))
        wanted = self._pace * LONGEST_CALL / max(seconds, 1e-9)
        self._pace = int(np.clip(wanted, 1, min(MOST_STEPS, 8 * self._pace)))

    def _status(self) -> Status:
        if self._flag < 0:
            return Status.FAILED
        return {STOP_RETURN: Status.STOP, ROOT_RETURN: Status.ROOT}.get(self._flag, Status.GOING)

    def failure(self) -> str:
        """Why the last call failed: one sentence."""
        return failure_sentence(self._flag)

    def roots(self) -> np.ndarray:
        """After `Status.ROOT`: for each switch +1 or -1 where it rose or fell through zero, else 0."""
        found = np.zeros(self.n_switches, dtype=np.intc)
        self._must(self._session.libraries.IDAGetRootInfo(self._memory, found.ctypes.data))
        return found

    def interpolate(self, t: float, derivative: int = 0) -> np.ndarray:
        """The solution, or one of its derivatives up to the last order, at a time within the last step.

        Raises
        ------
        ValueError
            When the time or the order of the derivative is beyond the last step's.
        """
        self._must(self._session.libraries.IDAGetDky(self._memory, t, derivative, self._at_output))
        return self._output.copy()

    def statistics(self) -> dict[str, int]:
        """Counters since the first beginning, and the order of the last step."""
        return self._statistics.counted()

    def worst(self) -> tuple[int, float]:
        """The unknown with the largest estimated error in the last step, and that error in units of its tolerance."""
        s, errors, weights = self._session.libraries, np.empty(len(self.y)), np.empty(len(self.y))
        for read, target in ((s.IDAGetEstLocalErrors, errors), (s.IDAGetErrWeights, weights)):
            self._must(read(self._memory, self._at_output))
            target[:] = self._output
        weighted = np.abs(errors) * weights * self._counts_in_error_test
        k = int(np.argmax(weighted))
        return k, float(weighted[k])

    def close(self) -> None:
        """Free what SUNDIALS holds; the instance cannot be used afterwards. Done by itself with the last reference."""
        self._finalizer()
