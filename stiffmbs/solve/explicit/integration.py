"""State and memory of one Runge-Kutta integration, shared with compiled code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

import numpy as np

from ...compile.machine.layout import address
from ...compile.machine.native.statuses import NOT_FINITE, SINGULAR, STEP_TOO_SMALL, STIFF
from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...dynamics.storage import FAILURES
from ...model.settings import RunSettings
from ..error_control.tolerances import absolute_tolerances
from ..events.event_functions import EventSearch, StepBound
from ..events.whole_steps import WholeSteps
from ..stiff_rows import States
from ..trajectory import Grid
from .native.parameters import CONTROL
from .scheme import Scheme, StepMemory

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
    """State, stages and counters of one integration, and memory for the rows that one call stores.

    - `scheme`: Runge-Kutta scheme.
    - `capacity`: largest number of steps, and of rows, of one call.
    - `step_times`: ends of the steps of each call.
    - `watch`: event functions, and what the search for events has found.
    - `t`: current time, s. `q`, `u`: current positions and velocities, parts of `y`.
    - `span`: length of the last step, s.
    - `h`: length of the next step, s. `stable`: longest step that stability allows, s; 0 if not computed.
    - `eliminates`: True if accelerations are computed by elimination where its pivots are accurate, False if by LU
      always.
    - `at`: address of the table for compiled code.
    - `atol` of shape (n_q + n_u,): absolute tolerances.
    """

    t, span, h, stable, eliminates = _Cell(float), _Cell(float), _Cell(float), _Cell(float), _Cell(bool)

    def __init__(
        self, scheme: Scheme, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, capacity: int | None = None
    ) -> None:  # fmt: skip
        self.scheme = scheme
        n_q = len(start.q)
        self._memory = memory = dynamics.kept(
            f"steps of {scheme.name}", capacity, lambda: StepMemory(scheme, dynamics, capacity)
        )
        self.capacity, self._n_q, self._dynamics = memory.capacity, n_q, dynamics
        self.step_times: list[np.ndarray] = []
        self._collected = 0  # steps whose ends have been collected
        self.step_bound, self.watch = StepBound(), EventSearch(dynamics.state)
        self.watch.end_steps_at_kinks()
        self.watch.follow_reactions(dynamics)
        self.watch.resolve(grid.end - grid.start)
        memory.renew(self.watch.table, self.step_bound.table)
        self.y, self.q, self.u, self.at = memory.y, memory.y[:n_q], memory.y[n_q:], address(memory.table)
        self.atol = dynamics.kept("tolerances", settings, lambda: absolute_tolerances(dynamics.system, settings))
        memory.atol[:] = self.atol
        self._cells = cells = memory.cells
        cells["project"], cells["rtol"] = settings.projection, settings.rtol
        cells["longest"], cells["stable"] = settings.max_step or np.inf, np.inf
        cells["shortest"] = CONTROL.shortest * (grid.end - grid.start)
        cells["t"] = cells["t_before"] = grid.start
        cells["h"], cells["repeats"] = settings.step, 1.0
        self.begin(start)

    @property
    def memory(self) -> StepMemory:
        """Arrays of the steps, and their table."""
        return self._memory

    @property
    def unresolved(self) -> float:
        """Time of the first linearly implicit step that did not resolve a growth, s; NaN if there is none."""
        return self._memory.unresolved

    def begin(self, start: InitialValues) -> None:
        """Restart from consistent values at the current time."""
        memory, cells = self._memory, self._cells
        self.q[:], self.u[:] = start.q, start.u
        memory.end_rates[self._n_q :] = start.acceleration
        memory.lam[:] = start.lam
        cells["started"], cells["last_error"], cells["at_event"] = 0, 0.0, 0
        cells["uncertain"], cells["distance"], cells["distance_of_end"] = 0, np.inf, np.inf
        self.watch.begin()

    def report_at(self, times: np.ndarray) -> None:
        """Report at these output times, s, from now on."""
        self._memory.report_at(np.ascontiguousarray(times))

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
        begin, end, y = self._memory.whole_steps.kept()
        return (WholeSteps(self._dynamics, begin, end, y[..., : self._n_q], y[..., self._n_q :]),)

    def collect(self) -> tuple[np.ndarray, States]:
        """Return times, and q and u, of the rows of the last call, valid up to the next one; keep the ends of its steps."""
        count, before, memory = self.count("rows"), self._collected, self._memory
        self._cells["rows"], self._collected = 0, self.count("steps")
        self.step_times.append(memory.ends[np.arange(before, self._collected) % self.capacity])
        rows = memory.row_y[:count]
        return memory.row_t[:count], (rows[:, : self._n_q], rows[:, self._n_q :])


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
