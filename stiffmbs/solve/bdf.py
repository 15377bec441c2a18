"""BDF of variable order and step: SUNDIALS IDA through scikit-sundae, as Adams' GSTIFF."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..compile.equations import Equations
from ..compile.layout import IDA, packed
from ..compile.routines import Routine
from ..compile.state import State
from ..describe.settings import RunSettings
from .formulations import FORMULATIONS
from .initial import InitialValues
from .mechanics import Mechanics
from .tolerances import absolute_tolerances
from .trajectory import Grid, Outcome, Rows, Trajectory, Watch

_MODULE = "stiffmbs.solve.native.ida_callbacks"
RESIDUAL = Routine(_MODULE, "residual", "void(float64, int64, int64, int64, int64*)")
JACOBIAN = Routine(_MODULE, "jacobian", "void(float64, int64, int64, float64, int64, int64*)")

DENSE_UP_TO = 90
"""Unknowns up to which the dense linear solver is as fast as the sparse one."""
OUT_OF_THE_ERROR_TEST = 1e15
"""Absolute tolerance of multipliers, which scikit-sundae cannot suppress in the error test (measured: without this
the index-2 problems fail; with it the tolerance has to be corrected for the unknowns that still count in the norm)."""
HISTORY_HEAD, HISTORY_ROOM = 4, 200_000
MOST_STEPS_BETWEEN_OUTPUTS = 10_000_000


class Callbacks:
    """Residual and Jacobian of one formulation as IDA calls them, and the history of IDA's steps.

    Parameters
    ----------
    equations : Equations
    state : State
    dense : bool
        Whether the Jacobian is a full matrix, or the values of the pattern's entries by columns.
    """

    def __init__(self, equations: Equations, state: State, dense: bool = True) -> None:
        state.load(equations.formulation.residual_set)
        state.load(equations.formulation.matrix_set)
        rows, columns = equations.pattern
        slots = rows * equations.n + columns if dense else None
        self._history = np.zeros(HISTORY_HEAD + HISTORY_ROOM)
        self._history[3] = HISTORY_ROOM
        self._equations_table, slot_of_entry = equations.table(slots)
        fields = {
            "state": state.table, "equations": self._equations_table, "history": self._history,
            "array_header": object.__basicsize__,
        }  # fmt: skip
        table = packed(IDA, fields)
        self._kept = (state, equations, slot_of_entry, table)
        self.residual, self.jacobian = self._residual(table.ctypes.data), self._jacobian(table.ctypes.data)

    @staticmethod
    def _residual(table: int) -> Any:
        call = RESIDUAL.load()

        def residual(t: float, y: np.ndarray, yp: np.ndarray, r: np.ndarray) -> None:
            call(t, id(y), id(yp), id(r), table)  # asking an array for .ctypes.data costs more than the residual

        return residual

    @staticmethod
    def _jacobian(table: int) -> Any:
        call = JACOBIAN.load()

        def jacobian(t: float, y: np.ndarray, yp: np.ndarray, r: np.ndarray, cj: float, a: np.ndarray) -> None:
            call(t, id(y), id(yp), cj, id(a), table)

        return jacobian

    def begin(self, t: float) -> None:
        """Start a new history."""
        self._history[:3] = t, 0, 0

    @property
    def steps(self) -> int:
        """Accepted steps so far."""
        return int(self._history[1])

    @property
    def rejected(self) -> int:
        """Steps tried in vain so far."""
        return int(self._history[2])

    @property
    def step_times(self) -> np.ndarray:
        """Ends of the accepted steps, the first `HISTORY_ROOM` of them."""
        return self._history[HISTORY_HEAD : HISTORY_HEAD + min(self.steps, HISTORY_ROOM)].copy()


class _Ida:
    """IDA set up for one system and formulation."""

    def __init__(self, mechanics: Mechanics, settings: RunSettings) -> None:
        from sksundae.ida import IDA as SundialsIda

        self.equations = Equations(FORMULATIONS[settings.formulation], mechanics.system)
        dense = self.equations.n <= DENSE_UP_TO
        self.callbacks = Callbacks(self.equations, mechanics.state, dense)
        linear: dict[str, Any] = (
            {"linsolver": "dense"} if dense else {"linsolver": "sparse", "sparsity": self._sparsity()}
        )
        rtol, atol = self._tolerances(settings)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Custom sparse Jacobian")  # said whenever sparsity and jacfn meet
            self._ida = SundialsIda(
                self.callbacks.residual, jacfn=self.callbacks.jacobian, rtol=rtol, atol=atol,
                max_num_steps=MOST_STEPS_BETWEEN_OUTPUTS, max_step=settings.max_step, **linear,
            )  # fmt: skip

    def _sparsity(self) -> Any:
        from scipy.sparse import csc_matrix

        rows, columns = self.equations.pattern
        return csc_matrix((np.ones(len(rows)), (rows, columns)), shape=(self.equations.n,) * 2)

    def _tolerances(self, settings: RunSettings) -> tuple[float, np.ndarray]:
        """IDA's tolerances: its norm divides by all unknowns, the tolerance asked for counts positions and velocities."""
        at, system = self.equations.at, self.equations.system
        correction = np.sqrt(self.equations.n / (system.n_q + system.n_u))
        atol = np.full(self.equations.n, OUT_OF_THE_ERROR_TEST)
        atol[at["q"]] = atol[at["u"]] = absolute_tolerances(system, settings)
        return settings.rtol * correction, atol * correction

    def begin(self, start: InitialValues, t: float) -> Any:
        """Start at consistent values."""
        at = self.equations.at
        y, yp = np.zeros(self.equations.n), np.zeros(self.equations.n)
        y[at["q"]], y[at["u"]] = start.q, start.u
        y[at["lam"]] = start.lam
        yp[at["q"]], yp[at["u"]] = start.u, start.acceleration
        self.callbacks.begin(t)
        return self._ida.init_step(t, y, yp)

    def results(self, grid: Grid) -> Iterator[Any]:
        """IDA's result at each time of the grid, or after each of its steps."""
        if grid.times is not None:
            for time in grid.times[1:]:
                yield self._ida.step(time, method="normal", tstop=grid.end)
            return
        t = grid.start
        while t < grid.end:
            result = self._ida.step(grid.end, method="onestep", tstop=grid.end)
            t = result.t
            yield result


def solve(mechanics: Mechanics, start: InitialValues, grid: Grid, settings: RunSettings, watch: Watch) -> Trajectory:
    """Integrate with IDA; the contract is in `stiffmbs.solve.trajectory`."""
    ida = _Ida(mechanics, settings)
    system = mechanics.system
    rows = Rows(system.n_q, system.n_u, len(grid.times) if grid.times is not None else 1024)
    rows.append(grid.start, start.q, start.u)
    at_q, at_u = ida.equations.at["q"], ida.equations.at["u"]
    outcome, message, result = Outcome.DONE, Outcome.DONE.value, ida.begin(start, grid.start)
    begun = time.perf_counter()
    try:
        for result in ida.results(grid):
            if result.status < 0:
                outcome, message = Outcome.STOPPED, _stopped_sentence(result)
                break
            rows.append(result.t, result.y[at_q], result.y[at_u])
            watch(result.t)
    except KeyboardInterrupt:
        outcome, message = Outcome.INTERRUPTED, Outcome.INTERRUPTED.value
    statistics = {
        "steps": ida.callbacks.steps, "rejected": ida.callbacks.rejected, "residuals": result.nfev,
        "jacobians": result.njev, "seconds": time.perf_counter() - begun,
    }  # fmt: skip
    return Trajectory(*rows.stored, outcome, message, statistics, ida.callbacks.step_times)


def _stopped_sentence(result: Any) -> str:
    return f"IDA stopped at t = {result.t:.9g} s: {result.message.rstrip('.').lower()}"
