"""IDA started anew at one instant after the other, as inputs jump: one compiled call for each."""

from __future__ import annotations

import numpy as np

from ....compile.machine.layout import packed
from ....compile.machine.routines import Routine
from ....compile.system import System
from ...native.tables.steps import RESTART
from ..connection import Connection
from .starts import Starts

_RESTART = Routine("stiffmbs.solve.ida.native.restart", "restart", "int32(float64, float64, int64*)")


class Restarts:
    """The present state, and a way to later ones that forgets what was behind it.

    Parameters
    ----------
    starts : Starts
        Of IDA.
    present : tuple of ndarrays, shapes (n_q,), (n_u,)
        Memory of the present q and u, which `advance` starts from and writes.

    Attributes
    ----------
    table : ndarray of int
        For compiled code (`stiffmbs.solve.native.tables.steps.RESTART`).
    """

    def __init__(self, starts: Starts, present: tuple[np.ndarray, np.ndarray]) -> None:
        q, u = present
        self._kept = starts, q, u
        self.table = packed(RESTART, {"start": starts.table, "q": q, "u": u})
        self._call, self._at = _RESTART.call, self.table.ctypes.data

    @staticmethod
    def serve(system: System, connection: Connection) -> bool:
        """Whether a compiled start does all that one needs: no event functions to look at, no algebraic states or turns to be counted
        anew, no threads of a linear solver to hold back."""
        counted = system.n_event_functions or system.n_counters or len(system.algebraic_coordinates)
        return not counted and connection.on_one_thread

    def advance(self, t: float, end: float) -> bool:
        """Go on from the state at t, s, made consistent, to a later time; False, with the state as it was, where that takes a run."""
        done: bool = self._call(t, end, self._at) == 0
        return done
