"""Log of the steps of scenes with Python functions, with the integrator's polynomial within each.

The functions have no breakpoints that a search within steps could find. They are checked after the run.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebvander

from ...compile.machine.layout import Table, fill
from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ..ida.native.parameters import LOOP
from .native.layouts import WHOLE_STEPS

if TYPE_CHECKING:
    from ..stiff_rows import States

WHOLE = 0.5 - 0.5 * np.cos(np.arange(8) * np.pi / 7)
"""Nodes that represent a whole step: the interpolant of DOP853 has degree 7, that of BDF at most 5."""


class Motion(NamedTuple):
    """States within steps, one row each.

    `t`, `q`, `u`, `rate` of shapes (m,), (m, n_q), (m, n_u), (m, n_u): times, states, and rates of u by the
    integrator's polynomial.
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    rate: np.ndarray


class WholeSteps(NamedTuple):
    """Steps of one run.

    `dynamics`: dynamics of the integrated system. `begin`, `end` of shape (n,): s. `q`, `u`: states at `WHOLE`.
    `full`: True if later steps were not stored.
    """

    dynamics: Dynamics
    begin: np.ndarray
    end: np.ndarray
    q: np.ndarray
    u: np.ndarray
    full: bool = False

    def at(self, step: np.ndarray, part: np.ndarray) -> Motion:
        """Return the states at parts (0 to 1) of steps, both of shape (m,)."""
        length = (self.end - self.begin)[step]
        to_series = np.linalg.inv(chebvander(2.0 * WHOLE - 1.0, len(WHOLE) - 1))
        q, u = (np.einsum("kl,nlj->nkj", to_series, states) for states in (self.q, self.u))
        places = chebvander(2.0 * part - 1.0, len(WHOLE) - 1)
        slopes = 2.0 * places[:, :-1] / length[:, None]
        weighted = ((places, q), (places, u), (slopes, chebder(u, axis=1)))
        found = (np.einsum("mk,mkj->mj", weights, series[step]) for weights, series in weighted)
        return Motion(self.begin[step] + part * length, *found)


class WholeStepLog:
    """Memory for the steps of one integration, filled by compiled code; for none without Python functions.

    `width`: number of values stored of a state. `table`: addresses for compiled code
    (`stiffmbs.solve.events.native.layouts.WHOLE_STEPS`).
    """

    def __init__(self, system: System, width: int) -> None:
        numbers = 2 + len(WHOLE) * width
        room = LOOP.most_items // numbers if system.has_functions else 0
        self._rows, self._width = np.empty((room, numbers)), width
        self.table = Table(WHOLE_STEPS)
        if room:
            arrays = {"n_nodes": len(WHOLE), "node": WHOLE, "width": width, "row": self._rows, "room": room}
            fill(self.table, arrays)
        self._cells = self.table.view(WHOLE_STEPS.cells)[0]

    def forget(self) -> None:
        """Drop all steps."""
        self._cells["count"] = 0

    def kept(self, dynamics: Dynamics, states: Callable[[np.ndarray], States]) -> tuple[WholeSteps, ...]:
        """Return the stored steps, none without Python functions. `states`: returns q and u of rows of stored values."""
        rows = self._rows[: int(self._cells["count"])].copy()
        if not len(rows):
            return ()
        q, u = (part.reshape(len(rows), len(WHOLE), -1) for part in states(rows[:, 2:].reshape(-1, self._width)))
        return (WholeSteps(dynamics, rows[:, 0], rows[:, 1], q, u, full=len(rows) == len(self._rows)),)
