"""Log of steps much longer than their predecessors, with the integrator's polynomial within each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebvander

from ...compile.equations import Equations
from ...compile.machine.layout import packed
from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...tuning import tuned
from ..ida.native.parameters import LOOP
from .native.layouts import LONG_STEPS


@dataclass(frozen=True)
class LongStepParameters:
    """Parameters that decide which steps are stored to be checked after the run.

    Laws are searched for events as well; Python functions, which have none, are checked in all steps.
    """

    from_middle: float = 1e-4
    """Distance from the middle of a step, relative to the step, of two stored states."""
    for_others: tuple[float, float] = (4.0, 8.0)
    """Ratio of a long step to the usual one, and number of steps over which the usual one is averaged."""


LONG_STEP = tuned("long_steps", LongStepParameters())

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


class LongSteps(NamedTuple):
    """Long steps of one run.

    `dynamics`: dynamics of the integrated system. `begin`, `end` of shape (n,): s. `q`, `u`: states at two places next
    to the middle of each step, or at `WHOLE`.
    """

    dynamics: Dynamics
    begin: np.ndarray
    end: np.ndarray
    q: np.ndarray
    u: np.ndarray

    @classmethod
    def of(
        cls, dynamics: Dynamics, equations: Equations, begin: np.ndarray, end: np.ndarray, rows: np.ndarray
    ) -> LongSteps:
        """Create the steps from the reported unknowns at the stored places, shape (n, places, n_reported)."""
        q, u = equations.states(rows.reshape(-1, rows.shape[-1]))
        shape = rows.shape[:2]
        return cls(dynamics, begin, end, q.reshape(*shape, -1), u.reshape(*shape, -1))

    @property
    def whole(self) -> bool:
        """Return True if the polynomial is known over whole steps."""
        return self.q.shape[1] == len(WHOLE)

    def middles(self, steps: np.ndarray) -> Motion:
        """Return the middles of some steps; for steps that are stored at two places."""
        begin, end, q, u = self.begin[steps], self.end[steps], self.q[steps], self.u[steps]
        rate = (u[:, 1] - u[:, 0]) / (2.0 * LONG_STEP.from_middle * (end - begin))[:, None]
        return Motion(0.5 * (begin + end), q.mean(axis=1), u.mean(axis=1), rate)

    def at(self, step: np.ndarray, part: np.ndarray) -> Motion:
        """Return the states at parts (0 to 1) of steps, both of shape (m,); for steps that are stored at `WHOLE`."""
        length = (self.end - self.begin)[step]
        to_series = np.linalg.inv(chebvander(2.0 * WHOLE - 1.0, len(WHOLE) - 1))
        q, u = (np.einsum("kl,nlj->nkj", to_series, states) for states in (self.q, self.u))
        places = chebvander(2.0 * part - 1.0, len(WHOLE) - 1)
        slopes = 2.0 * places[:, :-1] / length[:, None]
        weighted = ((places, q), (places, u), (slopes, chebder(u, axis=1)))
        found = (np.einsum("mk,mkj->mj", weights, series[step]) for weights, series in weighted)
        return Motion(self.begin[step] + part * length, *found)


class LongStepLog:
    """Memory for the long steps of one integration, filled by compiled code.

    `width`: number of values stored of a state. `table`: addresses for compiled code
    (`stiffmbs.solve.events.native.layouts.LONG_STEPS`).
    """

    def __init__(self, system: System, width: int) -> None:
        places = WHOLE if system.has_functions else np.array([0.5 - LONG_STEP.from_middle, 0.5 + LONG_STEP.from_middle])
        ratio, remembered = (0.0, 1.0) if system.has_functions else LONG_STEP.for_others
        row = 2 + len(places) * width
        room = LOOP.most_items // row if system.has_laws else 0
        self._rows, self._shape = np.empty((room, row)), (len(places), width)
        self._arrays = {"n_nodes": len(places), "node": places, "width": width, "row": self._rows}
        self.table = packed(LONG_STEPS, {**self._arrays, "ratio": ratio, "remembered": remembered, "room": room})
        self._cells = self.table.view(LONG_STEPS.cells)[0]

    def forget(self) -> None:
        """Drop all steps."""
        self._cells["count"], self._cells["usual"] = 0, 0.0

    def kept(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the begin and end of each stored step, and its states, shape (n, places, width)."""
        rows = self._rows[: int(self._cells["count"])].copy()
        return rows[:, 0], rows[:, 1], rows[:, 2:].reshape(len(rows), *self._shape)
