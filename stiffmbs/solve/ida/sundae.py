"""IDA through scikit-sundae, with compiled residual, Jacobian and root functions called from Python."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...compile.equations import Equations
from ...compile.inputs.features import InputFeatures
from ...compile.machine.layout import packed
from ...compile.machine.routines import Routine
from ...compile.state import State
from ..error_control.newton import Stiffness
from ..native.tables.steps import IDA
from ..trajectory import History
from .engine import Reached

if TYPE_CHECKING:
    from ..initial import InitialValues

_MODULE = "stiffmbs.solve.native.ida_callbacks"
RESIDUAL = Routine(_MODULE, "residual", "void(float64, int64, int64, int64, int64*)")
JACOBIAN = Routine(_MODULE, "jacobian", "void(float64, int64, int64, float64, int64, int64*)")
SWITCHES = Routine(_MODULE, "event_functions", "void(float64, int64, int64, int64, int64*)")

MOST_ENDS = 200_000
"""Ends of steps kept."""
DENSE_UP_TO = 90
"""Unknowns up to which the dense linear solver is as fast as the sparse one."""
STEPS_AT_ONCE = 20_000
"""Steps after which it hands over where it is."""
TOO_MUCH_WORK = -1
"""IDA's status where a call has come to its most steps: it goes on when it is called again."""
TOGETHER = 20
"""Output times that are handed over together, as a handing over costs more than a step."""
ROOT_FOUND = 2
"""IDA's status for a step that ended at a root."""


class Callbacks:
    """Residual and Jacobian of one formulation as IDA calls them, and the history of IDA's steps.

    Parameters
    ----------
    equations : Equations
    state : State
    dense : bool
        Whether the Jacobian is a full matrix, or the values of the pattern's entries by columns.

    Attributes
    ----------
    masked : ndarray of int
        For how many steps each event function is still left out (`stiffmbs.solve.native.event_search.event_signs`).
    """

    def __init__(self, equations: Equations, state: State, dense: bool = True) -> None:
        state.load(equations.formulation.residual_set)
        state.load(equations.formulation.matrix_set)
        state.load("event_function")
        rows, columns = equations.pattern
        slots = rows * equations.n + columns if dense else None
        self._ends = np.zeros(MOST_ENDS)
        n_event_functions = state.system.n_event_functions
        self._signs, self.masked = np.zeros(n_event_functions), np.zeros(n_event_functions, dtype=np.int64)
        self._equations_table, slot_of_entry = equations.table(slots)
        fields = {
            "state": state.table, "equations": self._equations_table, "n_ends": MOST_ENDS, "ends": self._ends,
            "array_header": object.__basicsize__, "n_event_functions": n_event_functions, "signs": self._signs, "masked": self.masked,
        }  # fmt: skip
        table = packed(IDA, fields)
        self._kept, self._cells = (state, equations, slot_of_entry, table), table.view(IDA.cells)[0]
        at = table.ctypes.data
        self.residual, self.jacobian, self.event_functions = (
            self._residual(at),
            self._jacobian(at),
            self._event_functions(at),
        )

    @staticmethod
    def _residual(table: int) -> Any:
        call = RESIDUAL.call

        def residual(t: float, y: np.ndarray, yp: np.ndarray, r: np.ndarray) -> None:
            call(t, id(y), id(yp), id(r), table)  # asking an array for .ctypes.data costs more than the residual

        return residual

    @staticmethod
    def _jacobian(table: int) -> Any:
        call = JACOBIAN.call

        def jacobian(t: float, y: np.ndarray, yp: np.ndarray, r: np.ndarray, cj: float, a: np.ndarray) -> None:
            call(t, id(y), id(yp), cj, id(a), table)

        return jacobian

    @staticmethod
    def _event_functions(table: int) -> Any:
        call = SWITCHES.call

        def event_functions(t: float, y: np.ndarray, yp: np.ndarray, values: np.ndarray) -> None:
            call(t, id(y), id(yp), id(values), table)

        return event_functions

    def begin(self, t: float) -> None:
        """Go on with the history from an instant at which IDA starts anew, and look at the event functions' signs again."""
        self._cells["last_time"] = t
        self._signs[:] = 0.0

    @property
    def steps(self) -> int:
        """Accepted steps so far."""
        return int(self._cells["steps"])

    @property
    def rejected(self) -> int:
        """Steps tried in vain so far."""
        return int(self._cells["rejected"])

    @property
    def step_times(self) -> np.ndarray:
        """Ends of the accepted steps, the first `MOST_ENDS` of them."""
        return self._ends[: self.steps].copy()


class SundaeEngine:
    """IDA through scikit-sundae; the contract is in `stiffmbs.solve.ida.engine.Engine`.

    Parameters
    ----------
    equations : Equations
    state : State
        The working memory of residual and Jacobian.
    rtol : float
    atol : ndarray, shape (n,)
        Of each unknown; huge for those that are left out of the error test.
    max_step : float
        s; 0 for none.
    max_order : int
        Of the BDF formula, 1 to 5.
    """

    def __init__(
        self, equations: Equations, state: State, rtol: float, atol: np.ndarray, max_step: float, max_order: int = 5
    ) -> None:
        from sksundae.ida import IDA as SundialsIda

        self.equations = equations
        self._reported = equations.independent
        dense = equations.n <= DENSE_UP_TO
        self._linear_solver = f"{'dense' if dense else 'SuperLU_MT'}, {equations.n} unknowns"
        self.callbacks = Callbacks(equations, state, dense)
        options: dict[str, Any] = {"linsolver": "dense"} if dense else self._sparse()
        n_event_functions = state.system.n_event_functions
        if n_event_functions:
            options |= {"eventsfn": self.callbacks.event_functions, "num_events": n_event_functions}
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Custom sparse Jacobian")  # said whenever sparsity and jacfn meet
            self._ida = SundialsIda(
                self.callbacks.residual, jacfn=self.callbacks.jacobian, rtol=rtol, atol=atol,
                max_num_steps=STEPS_AT_ONCE, max_step=max_step, max_order=max_order, **options,
            )  # fmt: skip
        self._before = {"residuals": 0, "jacobians": 0}
        self._since = {"residuals": 0, "jacobians": 0}
        self._interrupted = False
        self._features = InputFeatures()

    def _sparse(self) -> dict[str, Any]:
        from scipy.sparse import csc_matrix

        rows, columns = self.equations.pattern
        pattern = csc_matrix((np.ones(len(rows)), (rows, columns)), shape=(self.equations.n,) * 2)
        return {"linsolver": "sparse", "sparsity": pattern}

    def forget(self) -> None:
        """Each run has a driver of its own."""

    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Stop where a longer step might miss what the inputs do; IDA goes on from there with its history."""
        self._features = features

    def leave_out(self, masked: np.ndarray) -> None:
        """Do not look at each event function for so many steps."""
        self.callbacks.masked[:] = masked

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float, stiffness: Stiffness) -> None:
        """Start, or start anew, at consistent values; scikit-sundae keeps IDA's own tolerance of Newton's iteration."""
        for name, count in self._since.items():
            self._before[name] += count
        self.callbacks.begin(t)
        self._last, self._near = self._ida.init_step(t, y, yp), t

    def begin_at(self, start: InitialValues, t: float) -> bool:
        """There is no such call of scikit-sundae."""
        return False

    def begin_anew(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float) -> None:
        """Nor one for that."""

    def to_times(self, times: np.ndarray, stops: Sequence[float]) -> Iterator[Reached]:
        """Integrate to the first stop and report at times up to there; ends early at an event or a failure."""
        stop = stops[0]
        times = times[times <= stop]
        ends_there, served = len(times) > 0 and times[-1] == stop, 0
        while served < len(times):
            reached = self._several(times[served : served + TOGETHER], stop)
            served += len(reached.times)
            yield reached
            if self._interrupted:
                raise KeyboardInterrupt
            if reached.fired or reached.failure:
                return
        while not ends_there:
            reached = self._reached(self._to(stop, stop), False)
            yield reached
            ends_there = bool(reached.fired or reached.failure or reached.t >= stop)

    def _several(self, times: np.ndarray, stop: float) -> Reached:
        """Integrate to the last of a few output times; to what ends it before."""
        rows, served = np.empty((len(times), len(self._reported))), 0
        last = self._last
        try:
            for time in times:
                last = self._to(time, stop)
                if last.status < 0 or last.status == ROOT_FOUND:
                    break
                rows[served] = last.y[self._reported]
                served += 1
        except KeyboardInterrupt:  # what was computed is handed over first
            self._interrupted = True
        return self._reached(last, False)._replace(times=times[:served], rows=rows[:served])

    def _to(self, time: float, stop: float) -> Any:
        """Integrate to a time, over the stops that inputs ask for on the way to `stop`."""
        while self._near < time:
            if self._last.t < self._near:
                self._last = self._ida.step(self._near, method="normal", tstop=self._near)
                if self._last.status < 0 or self._last.status == ROOT_FOUND:
                    return self._last
            self._near = self._next_stop(stop)
        self._last = self._ida.step(time, method="normal", tstop=self._near)
        return self._last

    def _next_stop(self, stop: float) -> float:
        """Where a step from the last such stop on must end at the latest."""
        return min(stop, self._near + self._features.longest_step(self._near))

    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report each step; ends early at an event or a failure."""
        while True:
            if self._last.t >= self._near:
                self._near = self._next_stop(stop)
            self._last = self._ida.step(stop, method="onestep", tstop=self._near)
            reached = self._reached(self._last, True)
            yield reached
            if reached.fired or reached.failure or reached.t >= stop:
                return

    def _reached(self, result: Any, asked_for: bool) -> Reached:
        self._since = {"residuals": result.nfev, "jacobians": result.njev}
        failed = result.status < 0 and result.status != TOO_MUCH_WORK
        failure = result.message.rstrip(".").lower() if failed else ""
        fired = tuple(map(int, np.flatnonzero(result.i_events[-1]))) if result.status == ROOT_FOUND else ()
        rows = 1 if asked_for and not failure and not fired else 0
        times, y = np.array([result.t])[:rows], np.asarray(result.y)
        return Reached(times, y[None, self._reported][:rows], result.t, y, fired, failure)

    def pause_after(self, steps: int) -> None:
        """It reports after each few output times as it is."""

    def note(self) -> str:
        """Nothing: its orders are IDA's own affair."""
        return ""

    def steps(self) -> int:
        """Taken since the first start."""
        return self.callbacks.steps

    def statistics(self) -> dict[str, int | float | str]:
        """The linear solver, and counters since the first start."""
        calls = {name: self._before[name] + self._since[name] for name in self._before}
        return {
            "linear_solver": self._linear_solver,
            "steps": self.callbacks.steps,
            "rejected": self.callbacks.rejected,
            **calls,
        }

    def last_step(self) -> tuple[float, int] | None:
        """Size, s, and order of the last step: scikit-sundae gives none of them."""
        return None

    def long_steps(self) -> None:
        """None are kept."""

    def displaced(self) -> None:
        """Not known: scikit-sundae does not give IDA's error estimates."""

    def history(self) -> History:
        """Ends of the steps; their orders are not known here."""
        return History(self.callbacks.step_times, np.empty(0, dtype=int))
