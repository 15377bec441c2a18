"""Driver of IDA by scikit-sundae, with compiled residual, Jacobian and event functions called from Python."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ...compile.equations import Equations
from ...compile.inputs.features import InputFeatures
from ...compile.machine.layout import packed
from ...compile.machine.native.statuses import ROOT_RETURN
from ...compile.machine.routines import Routine
from ...compile.state import State
from ...tuning import tuned
from ..error_control.newton import Stiffness
from ..trajectory import History
from .engine import Engine, Reached
from .native.layouts import IDA
from .native.parameters import LOOP


@dataclass(frozen=True)
class FallbackParameters:
    """Parameters of IDA by scikit-sundae's callbacks."""

    dense_up_to: int = 90
    """Number of unknowns up to which the dense linear solver is used."""


FALLBACK = tuned("sundae", FallbackParameters())

if TYPE_CHECKING:
    pass

_MODULE = "stiffmbs.solve.ida.native.ida_callbacks"
RESIDUAL = Routine(_MODULE, "residual", "void(float64, int64, int64, int64, int64*)")
JACOBIAN = Routine(_MODULE, "jacobian", "void(float64, int64, int64, float64, int64, int64*)")
SWITCHES = Routine(_MODULE, "event_functions", "void(float64, int64, int64, int64, int64*)")

TOO_MUCH_WORK: Final = -1
"""Status of IDA after the largest number of steps in a call; the next call continues."""


class Callbacks:
    """Residual and Jacobian callbacks of one formulation, and the history of IDA's steps.

    `dense`: if True, the Jacobian is a full matrix, otherwise the entries of the pattern by columns. `masked`:
    remaining steps for which each event function is masked (`stiffmbs.solve.ida.native.ida_memory`).
    """

    def __init__(self, equations: Equations, state: State, dense: bool = True) -> None:
        state.load(equations.formulation.residual_set)
        state.load(equations.formulation.matrix_set)
        state.load("event_function")
        rows, columns = equations.pattern
        slots = rows * equations.n + columns if dense else None
        self._ends = np.zeros(LOOP.most_items)
        n_event_functions = state.system.n_event_functions
        self._signs, self.masked = np.zeros(n_event_functions), np.zeros(n_event_functions, dtype=np.int64)
        self._equations_table, slot_of_entry = equations.table(slots)
        fields = {
            "state": state.table, "equations": self._equations_table, "n_ends": LOOP.most_items, "ends": self._ends,
            "array_header": object.__basicsize__, "n_event_functions": n_event_functions, "signs": self._signs, "masked": self.masked,
        }  # fmt: skip
        table = packed(IDA, fields)
        self._kept, self._cells = (state, equations, slot_of_entry, table), table.view(IDA.cells)[0]
        at = table.ctypes.data
        residual, jacobian, event_functions = RESIDUAL.call, JACOBIAN.call, SWITCHES.call
        # `id`, because .ctypes.data costs more than the residual
        self.residual = lambda t, y, yp, r: residual(t, id(y), id(yp), id(r), at)
        self.jacobian = lambda t, y, yp, r, cj, a: jacobian(t, id(y), id(yp), cj, id(a), at)
        self.event_functions = lambda t, y, yp, values: event_functions(t, id(y), id(yp), id(values), at)

    def begin(self, t: float) -> None:
        """Continue the history at a restart of IDA, and determine the signs of the event functions again."""
        self._cells["last_time"] = t
        self._signs[:] = 0.0

    @property
    def steps(self) -> int:
        """Return the number of accepted steps."""
        return int(self._cells["steps"])

    @property
    def rejected(self) -> int:
        """Return the number of rejected steps."""
        return int(self._cells["rejected"])

    @property
    def step_times(self) -> np.ndarray:
        """Return the ends of the accepted steps, up to a largest number."""
        return self._ends[: self.steps].copy()


class SundaeEngine(Engine):
    """IDA through scikit-sundae; implements `stiffmbs.solve.ida.engine.Engine`.

    `state`: working memory of residual and Jacobian. `atol` of shape (n,): tolerance of each unknown; huge for those
    excluded from the error test. `max_step`: largest step, s; 0 for none. `max_order`: highest order of BDF, 1 to 5.
    """

    def __init__(
        self, equations: Equations, state: State, rtol: float, atol: np.ndarray, max_step: float, max_order: int = 5
    ) -> None:
        from sksundae.ida import IDA as SundialsIda

        self.equations = equations
        self._reported = equations.independent
        dense = equations.n <= FALLBACK.dense_up_to
        self._linear_solver = f"{'dense' if dense else 'SuperLU_MT'}, {equations.n} unknowns"
        self.callbacks = Callbacks(equations, state, dense)
        options: dict[str, Any] = {"linsolver": "dense"} if dense else self._sparse()
        n_event_functions = state.system.n_event_functions
        if n_event_functions:
            options |= {"eventsfn": self.callbacks.event_functions, "num_events": n_event_functions}
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Custom sparse Jacobian")  # issued for any jacfn with sparsity
            self._ida = SundialsIda(
                self.callbacks.residual, jacfn=self.callbacks.jacobian, rtol=rtol, atol=atol,
                max_num_steps=LOOP.most_steps, max_step=max_step, max_order=max_order, **options,
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
        """Do nothing: each run has its own driver."""

    def pause_after(self, steps: int) -> None:
        """Do nothing: every few output times are reported anyway."""

    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Limit steps to resolve the features of inputs; IDA continues at such stops with its history."""
        self._features = features

    def leave_out(self, masked: np.ndarray) -> None:
        """Ignore each event function for a number of steps."""
        self.callbacks.masked[:] = masked

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float, stiffness: Stiffness) -> None:
        """Start or restart at consistent values; scikit-sundae keeps IDA's own Newton tolerance."""
        for name, count in self._since.items():
            self._before[name] += count
        self.callbacks.begin(t)
        self._last, self._near = self._ida.init_step(t, y, yp), t

    def to_times(self, times: np.ndarray, stops: Sequence[float]) -> Iterator[Reached]:
        """Integrate to the first stop and report at output times; end early at an event or a failure."""
        stop = stops[0]
        times = times[times <= stop]
        ends_there, served = len(times) > 0 and times[-1] == stop, 0
        while served < len(times):
            reached = self._several(times[served : served + LOOP.most_passed], stop)
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
        """Integrate to the last of a few output times, or to an event, a failure or an interruption."""
        rows, served = np.empty((len(times), len(self._reported))), 0
        last = self._last
        try:
            for time in times:
                last = self._to(time, stop)
                if last.status < 0 or last.status == ROOT_RETURN:
                    break
                rows[served] = last.y[self._reported]
                served += 1
        except KeyboardInterrupt:  # computed rows are reported first
            self._interrupted = True
        return self._reached(last, False)._replace(times=times[:served], rows=rows[:served])

    def _to(self, time: float, stop: float) -> Any:
        """Integrate to `stop`, with the intermediate stops that inputs require."""
        while self._near < time:
            if self._last.t < self._near:
                self._last = self._ida.step(self._near, method="normal", tstop=self._near)
                if self._last.status < 0 or self._last.status == ROOT_RETURN:
                    return self._last
            self._near = self._next_stop(stop)
        self._last = self._ida.step(time, method="normal", tstop=self._near)
        return self._last

    def _next_stop(self, stop: float) -> float:
        """Return the latest end of a step from the last such stop."""
        return min(stop, self._near + self._features.longest_step(self._near))

    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report each step; end early at an event or a failure."""
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
        fired = tuple(map(int, np.flatnonzero(result.i_events[-1]))) if result.status == ROOT_RETURN else ()
        rows = 1 if asked_for and not failure and not fired else 0
        times, y = np.array([result.t])[:rows], np.asarray(result.y)
        return Reached(times, y[None, self._reported][:rows], result.t, y, fired, failure)

    def steps(self) -> int:
        """Return the number of steps since the first start."""
        return self.callbacks.steps

    def statistics(self) -> dict[str, int | float | str]:
        """Return the name of the linear solver, and counters since the first start."""
        calls = {name: self._before[name] + self._since[name] for name in self._before}
        return {
            "linear_solver": self._linear_solver,
            "steps": self.callbacks.steps,
            "rejected": self.callbacks.rejected,
            **calls,
        }

    def history(self) -> History:
        """Return the ends of the steps, with unknown orders."""
        return History(self.callbacks.step_times, np.empty(0, dtype=int))
