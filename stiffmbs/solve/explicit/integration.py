"""The memory of one Runge-Kutta integration, laid out for compiled code."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compile.machine.layout import address, packed
from ...describe.settings import RunSettings
from ..dynamics import POSITION_TOLERANCE, Dynamics
from ..error_control.tolerances import absolute_tolerances
from ..events.event_functions import EventSearch
from ..events.long_steps import LongStepLog, LongSteps
from ..events.step_bound import StepBound
from ..initial import InitialValues, rates_of
from ..native.tables.steps import EXPLICIT
from ..trajectory import Grid, Rows
from .routines import END_AT_EVENT
from .scheme import Scheme

SHORTEST_PART = 1e-12
"""Shorter steps than this part of the run would never come to its end."""
MOST_STEPS, MOST_VALUES = 1024, 300_000
"""Of one call of compiled code: steps, and numbers in the rows that it stores, so that it returns soon."""


class Integration:
    """State, stages and counters of one integration, and memory for the rows that one call stores.

    Attributes
    ----------
    capacity : int
        Most steps, and most rows, of one call.
    step_times : list of ndarray
        Ends of the steps of each call.
    step_bound : StepBound
    atol : ndarray, shape (n_q + n_u,)
        Absolute tolerances.
    """

    def __init__(
        self, scheme: Scheme, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings
    ) -> None:
        self._n_q = len(start.q)
        n = self._n_q + len(start.u)
        self.capacity = max(1, min(MOST_STEPS, MOST_VALUES // max(n, 1)))
        self.step_times: list[np.ndarray] = []
        self._collected = 0  # steps whose ends have been taken over
        self._dynamics = dynamics
        self._scheme, self._eliminated = scheme, dynamics.eliminated
        self._end = scheme.stages
        self.step_bound = StepBound()
        self.atol = atol = absolute_tolerances(dynamics.system, settings)
        times = np.empty(0) if grid.times is None else np.ascontiguousarray(grid.times, dtype=float)
        n_event_functions = dynamics.system.n_event_functions
        self._watch = EventSearch(dynamics.state)
        self._long_steps = dynamics.kept("long_steps", n, lambda: LongStepLog(dynamics.system, n))
        self._long_steps.forget()
        self._arrays: dict[str, Any] = {
            "dynamics": dynamics.table, "eliminated": self._eliminated.table, "eliminates": self._eliminated.serves,
            "pivots_tell": self._eliminated.pivots_tell,
            "scheme": scheme.table, "n": n, "n_q": self._n_q,
            "project": settings.projection, "tolerance": POSITION_TOLERANCE,
            "rtol": settings.rtol, "atol": atol,
            "longest": settings.max_step or np.inf, "stable": np.inf, "step_bound": self.step_bound.table,
            "shortest": SHORTEST_PART * (grid.end - grid.start),
            "t": grid.start, "t_before": grid.start, "h": settings.step,
            "n_event_functions": n_event_functions, "end_at_event": END_AT_EVENT.address if self._watch.n else 0, "signs": np.zeros(n_event_functions),
            "watch": self._watch.table,
            "y": np.zeros(n), "y_before": np.zeros(n), "y_stage": np.zeros(n), "k": np.zeros((scheme.extended, n)), "difference": np.zeros(n), "weight": np.zeros(n),
            "polynomial": np.zeros((3 + len(scheme.dense), n)),
            "n_times": len(times), "times": times, "long_steps": self._long_steps.table,
            "capacity": self.capacity, "row_t": np.empty(self.capacity), "row_y": np.empty((self.capacity, n)),
            "ends": np.empty(self.capacity),
        }  # fmt: skip
        self._table = packed(EXPLICIT, self._arrays)
        self._cells = self._table.view(EXPLICIT.cells)[0]
        self.begin(start)

    @property
    def at(self) -> int:
        """The address of the table for compiled code."""
        return address(self._table)

    @property
    def t(self) -> float:
        """The time reached."""
        return float(self._cells["t"])

    @t.setter
    def t(self, value: float) -> None:
        self._cells["t"] = value

    @property
    def h(self) -> float:
        """The length of the next step, s."""
        return float(self._cells["h"])

    @h.setter
    def h(self, value: float) -> None:
        self._cells["h"] = value

    @property
    def stable(self) -> float:
        """The longest step that stability allows, s; 0 where it has not been asked for."""
        return float(self._cells["stable"])

    @stable.setter
    def stable(self, value: float) -> None:
        self._cells["stable"] = value

    @property
    def eliminates(self) -> bool:
        """Whether accelerations come by elimination, where pivots keep digits, and not always from the whole system."""
        return bool(self._cells["eliminates"])

    @eliminates.setter
    def eliminates(self, value: bool) -> None:
        self._cells["eliminates"] = value

    @property
    def q(self) -> np.ndarray:
        """Positions reached."""
        return self._arrays["y"][: self._n_q]

    @property
    def u(self) -> np.ndarray:
        """Velocities reached."""
        return self._arrays["y"][self._n_q :]

    def begin(self, start: InitialValues) -> int:
        """Go on from consistent values at the time reached; the first event_function of the event that was met there, or -1."""
        self.q[:], self.u[:] = start.q, start.u
        rates = rates_of(self._dynamics, self.t, start)
        self._arrays["k"][self._end] = np.concatenate([rates, start.acceleration])
        self._cells["last_error"], self._cells["at_event"] = 0.0, 0
        state, signs = self._dynamics.state, self._arrays["signs"]
        state.q[:], state.u[:] = start.q, start.u
        state.evaluate("event_function", self.t)
        signs[:] = state.values["event_function"][: len(signs)]
        met = np.flatnonzero(self._watch.found[: len(signs)])
        self._watch.begin()
        return int(met[0]) if len(met) else -1

    def count(self, name: str) -> int:
        """A counter: ``steps``, ``rejected``, ``accelerations``, ``stiff_steps`` (those that stability held back)."""
        return int(self._cells[name])

    def long_steps(self) -> tuple[LongSteps, ...]:
        """Steps far longer than those before them."""
        begin, end, y = self._long_steps.kept()
        return (LongSteps(self._dynamics, begin, end, y[..., : self._n_q], y[..., self._n_q :]),)

    def collect(self, rows: Rows) -> None:
        """Take over the rows and ends of steps that the last call stored, and leave their memory to the next."""
        count, before = self.count("rows"), self._collected
        y = self._arrays["row_y"][:count]
        rows.extend(self._arrays["row_t"][:count], y[:, : self._n_q], y[:, self._n_q :])
        self._cells["rows"] = 0
        self._collected = self.count("steps")
        self.step_times.append(self._arrays["ends"][np.arange(before, self._collected) % self.capacity])
