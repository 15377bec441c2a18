"""Explicit steps shortened by rounding: a remedy for the elimination, and a message on nearly redundant constraints.

If forces on a body of small inertia nearly cancel, u' = M^-1 (f - J^T lam) contains their rounding over the inertia.
The LU with pivoting of the full system does not.

If constraints are dependent up to 1e-8, J M^-1 J^T contains 1e-16, so that its pivots are rounding and accelerations
jump. The error control shortens steps until a jump within one satisfies the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...compile.machine.layout import address
from ...dynamics.dynamics import Dynamics
from ...dynamics.elimination.eliminated import ATTEMPT
from ...tuning import tuned
from ..error_control.relaxation import RELAXATION
from ..events.chattering import CHATTERING
from ..suspect import acceleration_name, suspect
from .integration import Integration
from .native.parameters import CONTROL, ENDS


@dataclass(frozen=True)
class RoundingParameters:
    """Parameters of the checks for rounding that shortens explicit steps."""

    few: int = 4
    """Sample times of the check of the elimination."""
    instants: int = 64
    """Sample times of the check for jumps."""
    within: float = 0.01
    """Fraction of a step that contains the sample times, over which a resolved force law is linear."""
    jumps: int = 8
    """Rank of the second difference that must be large; a breakpoint of a force law causes two."""
    part: float = 1e-3
    """Smallest jump, relative to the largest acceleration, so that rounding of large accelerations is excluded."""


ROUNDING = tuned("explicit_rounding", RoundingParameters())


class Rounding:
    """Checks of the effect of rounding on the steps of a run.

    `rtol`: relative tolerance of the integrator. `start`, `end`: of the run, s.
    """

    def __init__(self, dynamics: Dynamics, rtol: float, start: float, end: float) -> None:
        self._dynamics, self._rtol, self._end = dynamics, rtol, end
        self._soon, self._later = _Stretch(start, RELAXATION.check_interval), _Stretch(start, CONTROL.enough_steps)

    def look(self, work: Integration) -> str:
        """Check the current state if a check is due; return why the run ends there, or an empty string.

        If the elimination loses digits, the LU replaces it. The run ends if accelerations jump with the rounding of
        coordinates and govern the steps. The sentence names the acceleration and the suspect element.
        """
        mean_step = self._soon.mean_step(work)
        if mean_step and work.eliminates and self._loses_digits(work, mean_step):
            work.eliminates = False
        mean_step = self._later.mean_step(work)
        return (
            self._jumping(work, mean_step) if mean_step and self._end - work.t > CHATTERING.too_many * mean_step else ""
        )

    def _loses_digits(self, work: Integration, mean_step: float) -> bool:
        """Return True if errors of the elimination are large enough to shorten the steps."""
        found, off = np.empty(len(work.u)), []
        for t in self._along(work, ROUNDING.within * mean_step, ROUNDING.few):
            if ATTEMPT.call(t, address(found), address(self._dynamics.eliminated.table)):
                off.append(np.abs(found - self._dynamics.accelerate(t)[1]))
        self._dynamics.forget_pivots(within_run=True)
        return bool(off) and bool(np.any(mean_step * np.max(off, axis=0) > ENDS.harmful * self._tolerance(work)))

    def _jumping(self, work: Integration, mean_step: float) -> str:
        """Return a sentence on the acceleration whose jumps govern the steps, or an empty string."""
        jumps, tolerance = self._jumps(work, ROUNDING.within * mean_step), self._tolerance(work)
        k = int(np.argmax(jumps / tolerance))
        if not jumps[k] * mean_step > ENDS.harmful * tolerance[k]:
            return ""
        likely = suspect(self._dynamics, work.t, work.q.copy(), work.u.copy())
        return (
            f"rounding errors limit the steps ({CONTROL.enough_steps} steps cover {CONTROL.enough_steps * mean_step:.3g} s): rounding of the coordinates changes "
            f"{acceleration_name(self._dynamics.system, k)} by {jumps[k]:.2g}{likely}; expected constraints that are either exactly "
            "redundant or clearly independent, or solver bdf"
        )

    def _jumps(self, work: Integration, span: float) -> np.ndarray:
        """Return the size of repeated jumps of each acceleration on a short displacement ahead, shape (n_u,)."""
        accelerations = np.zeros((ROUNDING.instants, len(work.u)))
        for row, t in zip(accelerations, self._along(work, span, ROUNDING.instants), strict=True):
            status, acceleration = self._dynamics.accelerate(t)
            if status == 0:
                row[:] = acceleration
        jumps = np.sort(np.abs(np.diff(accelerations, 2, axis=0)), axis=0)[-ROUNDING.jumps]
        return np.where(jumps > ROUNDING.part * np.abs(accelerations).max(), jumps, 0.0)

    def _along(self, work: Integration, span: float, count: int) -> Iterator[float]:
        """Yield times on a short displacement ahead, with the state set to each in turn."""
        q, u, dynamics = work.q.copy(), work.u.copy(), self._dynamics
        for ahead in np.linspace(0.0, span, count).tolist():
            dynamics.state.q[:], dynamics.state.u[:] = dynamics.system.of_body.moved(q, ahead * u), u
            yield work.t + ahead

    def _tolerance(self, work: Integration) -> np.ndarray:
        tolerance: np.ndarray = work.atol[len(work.q) :] + self._rtol * np.abs(work.u)
        return tolerance


class _Stretch:
    """Steps between two checks."""

    def __init__(self, start: float, apart: int) -> None:
        self._t, self._steps, self._apart = start, 0, apart

    def mean_step(self, work: Integration) -> float:
        """Return the mean step length since the last check, s, or 0 if the next is not due."""
        taken, covered = work.count("steps") - self._steps, work.t - self._t
        if taken < self._apart:
            return 0.0
        self._t, self._steps = work.t, work.count("steps")
        return covered / taken
