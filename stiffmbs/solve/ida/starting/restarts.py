"""Repeated restarts of IDA where inputs jump, one compiled call for each interval."""

from __future__ import annotations

import numpy as np

from ....compile.machine.layout import packed
from ....compile.machine.routines import Routine
from ....compile.system import System
from ....dynamics.dynamics import Dynamics
from ..connection import Connection
from ..native.layouts import RESTART
from .starts import Starts

_RESTART = Routine("stiffmbs.solve.ida.starting.native.restart", "restart", "int32(float64, float64, int64*)")


class Restarts:
    """Current state, with integration to later times without history.

    Parameters
    ----------
    dynamics : Dynamics
    starts : Starts
        Compiled starts of IDA.
    present : tuple of ndarrays, shapes (n_q,), (n_u,)
        Memory of the current q and u, read and written by `advance`.

    Attributes
    ----------
    table : ndarray of int
        Table for compiled code (`stiffmbs.solve.ida.native.layouts.RESTART`).
    """

    def __init__(self, dynamics: Dynamics, starts: Starts, present: tuple[np.ndarray, np.ndarray]) -> None:
        q, u = present
        term = dynamics.system.term("position", "continuous_angle")
        if len(term.row):
            dynamics.state.load("position")
        source, row = (np.ascontiguousarray(places, dtype=np.int64) for places in (term.source, term.row))
        self._kept = starts, q, u, source, row
        self.table = packed(RESTART, {
            "start": starts.table, "q": q, "u": u, "n_counted": len(row), "counted_source": source, "counted_row": row,
        })  # fmt: skip
        self._call, self._at = _RESTART.call, self.table.ctypes.data

    @staticmethod
    def serve(system: System, connection: Connection) -> bool:
        """Return True if there are no event functions, algebraic states or solver threads."""
        excluded = system.n_event_functions or len(system.algebraic_coordinates)
        return not excluded and connection.on_one_thread

    def advance(self, t: float, end: float) -> bool:
        """Integrate from the state at t, s, to a later time; False, with the state unchanged, if it needs a run."""
        done: bool = self._call(t, end, self._at) == 0
        return done
