"""IDA started anew behind an event or a breakpoint, from a state that need not be consistent, by one compiled call."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ....compile.machine.layout import packed
from ....compile.machine.routines import Routine
from ...dynamics import Dynamics
from ...error_control.newton import AMPLIFIED
from ...events.discontinuity import LARGER_MOVE, direction_of
from ...events.restart import INDISTINCT
from ...events.velocity_jumps import WORTH_TELLING
from ...native.tables.steps import ANEW
from .starts import Starts

_ANEW = Routine("stiffmbs.solve.ida.native.anew", "anew", "int32(float64, float64, int64, int64, int64*)")


class Begun(NamedTuple):
    """A start of IDA's; the state at hand is the one there.

    Attributes
    ----------
    t : float
        Its time, s: that of the state given, or a little behind it.
    jump : float
        Largest change of a velocity from the state given, m/s or rad/s.
    meets : bool
        Whether event functions that follow velocities have other signs nearby: forces may drive the motion back to their zeros.
    """

    t: float
    jump: float
    meets: bool


class StartsAnew:
    """Compiled starts in the middle of a run.

    Parameters
    ----------
    starts : Starts
        Of IDA.
    dynamics : Dynamics
    least : float
        Least part of the error tolerance that is left of states within long steps.

    Attributes
    ----------
    starts : Starts
    may_pass : bool
        Whether breakpoints may be passed in one call: no event functions are looked at, and no forces follow multipliers.
    table : int
        Its address, for compiled code (`stiffmbs.solve.native.tables.steps.ANEW`).
    """

    def __init__(self, starts: Starts, dynamics: Dynamics, least: float) -> None:
        system, self._state = dynamics.system, dynamics.state
        for term_set in ("position", "event_function"):
            self._state.load(term_set)
        counted, n = system.term("position", "continuous_angle"), system.n_event_functions
        along_q, along_u = direction_of(dynamics)
        values: dict[str, Any] = {
            "start": starts.table, "n_event_functions": n, "first_limit": system.first_limit,
            "n_counted": len(counted.row), "counted_source": _integers(counted.source), "counted_row": _integers(counted.row),
            "reach": LARGER_MOVE, "along_q": along_q, "along_u": along_u,
            "amplified": AMPLIFIED, "least": least, "largest_jump": WORTH_TELLING, "indistinct": INDISTINCT,
            "q": np.empty(system.n_q), "u": np.empty(system.n_u), "values": np.empty(n), "found": np.empty(n, dtype=np.int64),
        }  # fmt: skip
        self.starts, self._kept = starts, values
        self._table = packed(ANEW, values)
        self._cells, self.table = self._table.view(ANEW.cells)[0], self._table.ctypes.data
        self.may_pass = not n and not len(system.term("acceleration", "f_lam").row)

    def begin(
        self, state: tuple[np.ndarray, np.ndarray], t: float, ahead: float, counted: bool, highest_order: int
    ) -> Begun | None:
        """Start at consistent values behind a state.

        Parameters
        ----------
        state : tuple of ndarrays, shapes (n_q,), (n_u,)
        t : float
            s.
        ahead : float
            How far the motion may be taken for straight, s, past events that come with the one at t; 0 for not at all.
        counted : bool
            Whether what IDA has counted belongs to this run.
        highest_order : int

        Returns
        -------
        Begun or None
            None where there are no consistent values, or a force is beyond its limits: nothing is started then.
        """
        self._state.q[:], self._state.u[:] = state
        if _ANEW.short_call(t, ahead, counted, highest_order, self.table) < 0:
            return None
        cells = self._cells
        return Begun(float(cells["t"]), float(cells["jump"]), bool(cells["meets"]))

    @property
    def t(self) -> float:
        """Time of the last start, s."""
        return float(self._cells["t"])

    @property
    def passed(self) -> tuple[int, int]:
        """How many breakpoints the last call has passed, and its steps before the last of them."""
        return int(self._cells["passed"]), int(self._cells["steps_before"])


def _integers(numbers: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(numbers, dtype=np.int64)
