"""Restart of IDA after an event or a breakpoint, from a state that may be inconsistent, by one compiled call."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....compile.machine.layout import packed
from ....compile.machine.object_code import SHORT
from ....compile.machine.routines import Routine
from ....dynamics.dynamics import Dynamics
from ....model.settings import RunSettings
from ...engine import Begun
from ...error_control.native.parameters import POLISHING
from ...events.discontinuity import JUMP, VELOCITY_JUMP, Jumps, direction_of
from ..native.layouts import EVENT_RESTART
from .starts import Starts, integers

_MODULE = "stiffmbs.solve.ida.starting.native.breakpoints"
RESTARTED = Routine(_MODULE, "restarted_at_event", "int32(float64, float64, int64, int64, int64*)", level=SHORT)
ADVANCE = Routine(_MODULE, "advance_from", "int32(float64, float64, int64, int64*)")


class EventRestarts:
    """Compiled restarts within a run.

    `starts`: compiled starts of IDA. `least`: least part of the error tolerance that may remain in states within long
    steps. `may_pass`: true if one call may pass several breakpoints: no event functions, and no forces that depend on
    multipliers. `table`: address of the memory of compiled code (`stiffmbs.solve.ida.native.layouts.EVENT_RESTART`).
    """

    def __init__(self, starts: Starts, dynamics: Dynamics, settings: RunSettings, least: float) -> None:
        jumps = Jumps(dynamics, settings)
        system, self._state = dynamics.system, dynamics.state
        for term_set in ("position", "event_function"):
            self._state.load(term_set)
        counted, n = system.term("position", "continuous_angle"), system.n_event_functions
        along_q, along_u = direction_of(dynamics)
        values: dict[str, Any] = {
            "start": starts.table, "n_event_functions": n, "first_limit": system.first_limit,
            "n_counted": len(counted.row), "counted_source": integers(counted.source), "counted_row": integers(counted.row),
            "reach": JUMP.larger_move, "along_q": along_q, "along_u": along_u,
            "amplified": POLISHING.amplified, "least": least, "largest_jump": VELOCITY_JUMP.least, "least_jump": jumps.least, "speed": jumps.scale,
            "q": np.empty(system.n_q), "u": np.empty(system.n_u), "values": np.empty(n), "found": np.empty(n, dtype=np.int64),
        }  # fmt: skip
        self.starts, self._kept = starts, values
        self._table = packed(EVENT_RESTART, values)
        self._cells, self.table = self._table.view(EVENT_RESTART.cells)[0], self._table.ctypes.data
        self._has_events = n > 0
        self.may_pass = not n and not len(system.term("acceleration", "f_lam").row)

    def begin(
        self, state: tuple[np.ndarray, np.ndarray], t: float, ahead: float, counted: bool, highest_order: int
    ) -> Begun | None:
        """Restart at consistent values after a state.

        `state` of shapes (n_q,), (n_u,). `t`: s. `ahead`: time of extrapolation past events simultaneous with the one
        at t, s; 0 for none. `counted`: true if IDA's counters belong to this run. Returns None, without a start, if
        there are no consistent values or a force is beyond its limits.
        """
        self._state.q[:], self._state.u[:] = state
        if RESTARTED.short_call(t, ahead, counted, highest_order, self.table) < 0:
            return None
        cells = self._cells
        return Begun(float(cells["t"]), bool(cells["jumps"]), bool(cells["meets"]))

    def advance(self, state: tuple[np.ndarray, np.ndarray], t: float, end: float, highest_order: int) -> bool:
        """Integrate a state, which is overwritten, to a later time; False, with the state unchanged, if it needs a run."""
        if self._has_events:
            return False
        (q, u), own = state, self._state
        own.q[:], own.u[:] = q, u
        if ADVANCE.call(t, end, highest_order, self.table) != 0:
            return False
        q[:], u[:] = own.q, own.u
        return True

    def resume_after(self, gap: float) -> None:
        """Set the time from a breakpoint to the restart after it, s."""
        self._cells["gap"] = gap

    @property
    def t(self) -> float:
        """Return the time of the last start, s."""
        return float(self._cells["t"])

    @property
    def passed(self) -> tuple[int, int]:
        """Return the number of breakpoints passed by the last call, and its steps before the last of them."""
        return int(self._cells["passed"]), int(self._cells["steps_before"])
