"""Memory of explicit integrations for compiled code, reused by the runs of a job."""

from __future__ import annotations

import numpy as np

from ...compile.machine.layout import packed
from ...compile.machine.routines import together
from ...dynamics.dynamics import POSITION_TOLERANCE, Dynamics
from ..error_control.native.layouts import ACCUMULATED_ERRORS
from .native.layouts import EXPLICIT
from .scheme import Scheme

ADVANCE, END_AT_EVENT, FASTEST_RATE = together(
    "stiffmbs.solve.explicit.native.runge_kutta",
    advance="int64(float64, int64, int64, int64, int64*)",
    end_at_event="int32(int64*)",
    fastest_rate="float64(float64, int64, float64*, float64*, int64*, int64*)",
)
MOST_STEPS, MOST_VALUES = 1024, 300_000
"""Limits of one call of compiled code: steps, and numbers in the stored rows."""
WATCH, STEP_BOUND, LONG_STEPS = (list(EXPLICIT).index(name) for name in ("watch", "step_bound", "long_steps"))
"""Columns of the table that each run sets."""


class StepMemory:
    """Arrays of explicit steps for a scheme and a number of output times, and their table.

    `n_times`: output times; 0 for rows after each step.

    - `capacity`: largest number of steps, and of rows, of one call.
    - `y`, `end_rates`, `lam` of shapes (n_q + n_u,), (n_q + n_u,), (n_c,): current state, its rates, and multipliers
      at a start.
    - `atol`, `times` of shapes (n_q + n_u,), (n_times,).
    - `displaced` of shape (n_u,): estimated position errors
      (`stiffmbs.solve.error_control.native.accumulated_errors`).
    - `row_t`, `row_y`, `ends` of shapes (capacity,), (capacity, n_q + n_u), (capacity,).
    - `table`: addresses and cells (`stiffmbs.solve.explicit.native.layouts.EXPLICIT`).
    - `cells`: cells of the table by name.
    """

    def __init__(self, scheme: Scheme, dynamics: Dynamics, n_times: int) -> None:
        system, eliminated = dynamics.system, dynamics.eliminated
        n, events = system.n_q + system.n_u, system.n_event_functions
        self.capacity = capacity = max(1, min(MOST_STEPS, MOST_VALUES // max(n, 1)))
        self.y, self.lam, self.atol, self.times = np.zeros(n), np.zeros(system.n_c), np.zeros(n), np.zeros(n_times)
        self.row_t, self.row_y, self.ends = np.empty(capacity), np.empty((capacity, n)), np.empty(capacity)
        stages = np.zeros((scheme.extended, n))
        self.end_rates = stages[scheme.stages]
        searched = system.n_values("event_function") > 0
        nothing = np.zeros(1, dtype=np.int64)
        self._sums = np.zeros((2, system.n_u))
        self.displaced = self._sums[1]
        self._of_errors = {
            "n": system.n_u, "place": system.n_q + np.arange(system.n_u), "mass": np.ascontiguousarray(system.mass), "damped_source": nothing,
            "damped_row": nothing, "damped_column": nothing, "damped_factor": np.zeros(1), "displaced": self._sums[0], "furthest": self._sums[1],
            "n_damped": 0,
        }  # fmt: skip
        self._errors = packed(ACCUMULATED_ERRORS, self._of_errors)
        self._new_errors = self._errors.copy()
        self._arrays = {
            "dynamics": dynamics.table, "eliminated": eliminated.table, "eliminates": eliminated.serves,
            "pivots_tell": eliminated.pivots_tell, "scheme": scheme.table, "n": n, "n_q": system.n_q,
            "tolerance": POSITION_TOLERANCE, "atol": self.atol,
            "n_event_functions": events, "end_at_event": END_AT_EVENT.address if searched else 0, "signs": np.zeros(events),
            "lam": self.lam, "y": self.y, "y_before": np.zeros(n), "y_stage": np.zeros(n), "k": stages, "difference": np.zeros(n),
            "weight": np.zeros(n), "polynomial": np.zeros((3 + len(scheme.dense), n)),
            "n_times": n_times, "times": self.times,
            "capacity": capacity, "row_t": self.row_t, "row_y": self.row_y, "ends": self.ends,
            "accumulated": self._errors, "halved": np.zeros(3 * n),
            "watch": nothing, "step_bound": nothing, "long_steps": nothing,
        }  # fmt: skip
        self.table = packed(EXPLICIT, self._arrays)
        self.cells, self._new = self.table.view(EXPLICIT.cells)[0], self.table.copy()

    def renew(self, watch: int, step_bound: int, long_steps: int) -> None:
        """Reset all cells for a new run, and set the addresses of its tables."""
        self.table[:] = self._new
        self._errors[:] = self._new_errors
        self._sums[:] = 0.0
        self.table[[WATCH, STEP_BOUND, LONG_STEPS]] = watch, step_bound, long_steps
