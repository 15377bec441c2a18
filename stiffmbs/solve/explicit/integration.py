"""State and memory of Runge-Kutta integrations, shared with compiled code."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from ...compile.machine.layout import address, packed
from ...compile.machine.native.statuses import NOT_FINITE, SINGULAR, STEP_TOO_SMALL, STIFF
from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...dynamics.native.parameters import CONSISTENCY
from ...dynamics.storage import FAILURES
from ...model.settings import RunSettings
from ..error_control.tolerances import tolerances_of
from ..events.event_functions import EventSearch, StepBound
from ..events.whole_steps import WholeStepLog, WholeSteps
from ..ida.native.parameters import LOOP
from ..stiff_rows import States
from ..trajectory import Grid
from .native.layouts import EXPLICIT
from .native.parameters import CONTROL
from .scheme import Scheme

if TYPE_CHECKING:
    from .linearly_implicit import LinearlyImplicit

T = TypeVar("T")


class _Cell(Generic[T]):
    """Number in the table of an `Integration`, under its name there."""

    def __init__(self, kind: Callable[[Any], T]) -> None:
        self._kind = kind

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, work: Integration, owner: type) -> T:
        return self._kind(work._cells[self._name])

    def __set__(self, work: Integration, value: T) -> None:
        work._cells[self._name] = value


class Integration:
    """State, stages and counters of explicit steps of a scheme, and memory for the rows that one call stores.

    - `scheme`: Runge-Kutta scheme.
    - `capacity`: largest number of steps, and of rows, of one call.
    - `step_times`: ends of the steps of each call of a run.
    - `watch`: event functions, and what the search for events has found.
    - `t`: current time, s. `q`, `u`: current positions and velocities, parts of `y`.
    - `end_rates`, `lam` of shapes (n_q + n_u,), (n_c,): rates and multipliers at a start.
    - `span`: length of the last step, s.
    - `h`: length of the next step, s. `stable`: longest step that stability allows, s; 0 if not computed.
    - `eliminates`: True if accelerations are computed by elimination where its pivots are accurate, False if by LU
      always.
    - `table`, `at`: table for compiled code (`stiffmbs.solve.explicit.native.layouts.EXPLICIT`), and its address.
    - `atol` of shape (n_q + n_u,): absolute tolerances.
    """

    t, span, h, stable, eliminates = _Cell(float), _Cell(float), _Cell(float), _Cell(float), _Cell(bool)

    @classmethod
    def of(
        cls, scheme: Scheme, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, capacity: int | None = None
    ) -> Integration:  # fmt: skip
        """Return the integration of a run, whose memory the dynamics keep, at consistent values."""
        found = dynamics.once(cls, scheme, capacity, name=scheme.name)
        found._begin_run(start, grid, settings)
        return found

    def __init__(self, dynamics: Dynamics, scheme: Scheme, capacity: int | None) -> None:
        system, eliminated = dynamics.system, dynamics.eliminated
        self.scheme, self._dynamics, self._n_q, n = scheme, dynamics, system.n_q, system.n_q + system.n_u
        self.capacity = capacity = capacity or max(1, min(LOOP.most_steps, LOOP.most_items // max(n, 1)))
        self.y, self.lam, self.atol = np.zeros(n), np.zeros(system.n_c), np.zeros(n)
        self.q, self.u = self.y[: system.n_q], self.y[system.n_q :]
        self._row_t, self._row_y, self._ends = (np.zeros(shape) for shape in (capacity, (capacity, n), capacity))
        stages, self._whole_steps = np.zeros((scheme.extended, n)), WholeStepLog(system, n)
        self.end_rates = stages[scheme.stages]
        nothing = np.zeros(1, dtype=np.int64)
        self._arrays = {
            "dynamics": dynamics.table, "eliminated": eliminated.table, "eliminates": eliminated.serves,
            "pivots_tell": eliminated.pivots_tell, "scheme": scheme.table, "n": n, "n_q": system.n_q,
            "tolerance": CONSISTENCY.position_tolerance, "atol": self.atol,
            "lam": self.lam, "y": self.y, "y_before": np.zeros(n), "y_first": np.zeros(n), "y_stage": np.zeros(n), "k": stages, "difference": np.zeros(n),
            "weight": np.zeros(n), "polynomial": np.zeros((3 + len(scheme.dense), n)),
            "times": np.empty(0), "capacity": capacity, "row_t": self._row_t, "row_y": self._row_y, "ends": self._ends,
            "watch": nothing, "step_bound": nothing, "whole_steps": self._whole_steps.table,
            "linear_step": 0, "linear": nothing, **self._linear_steps(),
        }  # fmt: skip
        self.table = packed(EXPLICIT, self._arrays)
        self._cells, self.at, self._new = self.table.view(EXPLICIT.cells)[0], address(self.table), np.array(self.table)

    def _linear_steps(self) -> dict[str, Any]:
        """Return the entries of linearly implicit steps; none for explicit schemes."""
        self._linear: LinearlyImplicit | None = None
        if not self.scheme.columns:
            return {}
        from .linearly_implicit import LINEAR_STEP, LinearlyImplicit

        self._linear = LinearlyImplicit(self._dynamics, self.scheme.columns)
        return {"linear_step": LINEAR_STEP, "linear": self._linear.table}

    def _begin_run(self, start: InitialValues, grid: Grid, settings: RunSettings) -> None:
        """Forget earlier runs, and begin another one."""
        dynamics, cells = self._dynamics, self._cells
        self.step_times: list[np.ndarray] = []
        self._collected = 0  # steps whose ends have been collected
        self.step_bound, self.watch = StepBound(), EventSearch(dynamics.state)
        self.watch.end_steps_at_kinks()
        self.watch.follow_reactions(dynamics)
        self.watch.resolve(grid.end - grid.start)
        self.table[:] = self._new
        self.table.link("watch", self.watch.table)
        self.table.link("step_bound", self.step_bound.table)
        self._whole_steps.forget()
        if self._linear:
            self._linear.forget()
        self.atol[:] = dynamics.once(tolerances_of, settings)
        cells["project"], cells["rtol"] = settings.projection, settings.rtol
        cells["longest"], cells["stable"] = settings.max_step or np.inf, np.inf
        cells["shortest"] = CONTROL.shortest * (grid.end - grid.start)
        cells["t"] = cells["t_before"] = grid.start
        cells["h"], cells["repeats"] = settings.step, 1.0
        self.begin(start)

    @property
    def unresolved(self) -> float:
        """Time of the first linearly implicit step that did not resolve a growth, s; NaN if there is none."""
        return self._linear.unresolved if self._linear else math.nan

    def begin(self, start: InitialValues) -> None:
        """Restart from consistent values at the current time."""
        cells = self._cells
        self.q[:], self.u[:] = start.q, start.u
        self.end_rates[self._n_q :] = start.acceleration
        self.lam[:] = start.lam
        cells["started"], cells["last_error"], cells["at_event"] = 0, 0.0, 0
        cells["uncertain"], cells["distance"], cells["distance_of_end"] = 0, np.inf, np.inf
        self.watch.begin()

    def report_at(self, times: np.ndarray) -> None:
        """Report at these output times, s, from now on."""
        self.table.link("times", np.ascontiguousarray(times))
        self._cells["n_times"], self._cells["next_time"] = len(times), 0

    def forget_rates(self) -> None:
        """Compute the rates at the current state again."""
        self._cells["rates_known"] = 0

    def fired(self) -> list[int]:
        """Return the event functions of the event that ended the last step."""
        return self.watch.found[: self.watch.n_event_functions].nonzero()[0].tolist()

    def count(self, name: str) -> int:
        """Return a counter: ``steps``, ``rejected``, ``accelerations`` or ``stiff_steps`` (limited by stability)."""
        return int(self._cells[name])

    def whole_steps(self) -> tuple[WholeSteps, ...]:
        """Return the steps that are to be checked after the run."""
        return self._whole_steps.kept(self._dynamics, self._states)

    def collect(self) -> tuple[np.ndarray, States]:
        """Return times, and q and u, of the rows of the last call, valid up to the next one; keep the ends of its steps."""
        count, before = self.count("rows"), self._collected
        self._cells["rows"], self._collected = 0, self.count("steps")
        self.step_times.append(self._ends[np.arange(before, self._collected) % self.capacity])
        return self._row_t[:count], self._states(self._row_y[:count])

    def _states(self, rows: np.ndarray) -> States:
        """Return q and u of rows of states."""
        return rows[:, : self._n_q], rows[:, self._n_q :]


_USE_BDF = "the scene is stiff; use solver bdf or radau"
REASONS = {
    **FAILURES,
    SINGULAR: f"{FAILURES[SINGULAR]}, and the motion may branch there; bdf and radau pass such poses",
    NOT_FINITE: "the solution has overflowed; the step is too long for the stiffness of the scene",
    STEP_TOO_SMALL: "the step that the tolerance requires has become too small: the motion has a singularity there, or "
    + _USE_BDF,
    STIFF: f"the steps that stability allows are so short that the run would take more than ten minutes; {_USE_BDF}",
}
"""Reasons by status."""


def stiff_sentence(work: Integration) -> str:
    """Return a sentence on steps limited by stability."""
    held = work.count("stiff_steps")
    return f"stability, not accuracy, limited {held} of {work.count('steps')} steps: {_USE_BDF}"
