"""Explicit steps that rounding shortens: mended where the elimination loses digits, told where constraints nearly repeat each other.

A body of little inertia takes forces that nearly cancel.  u' = M^-1 (f - J^T lam) then holds their rounding over the inertia, where the
LU of the whole system, with pivoting, does not.

Where constraints repeat each other but for 1e-8, J M^-1 J^T holds 1e-16: its pivots are rounding, and an equation counts at one state
and not at the next.  The error estimate sees jumps of the acceleration and shortens steps until a jump within one meets the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...compile.machine.layout import address
from ..dynamics import Dynamics
from ..linear.eliminated import ACCELERATE
from ..suspect import acceleration_name, suspect
from .integration import Integration

SOON, APART = 1000, 20_000
"""Steps from one look to the next: at the elimination, and at jumps."""
FEW, INSTANTS, WITHIN = 4, 64, 0.01
"""Instants of both, within such a part of a step, over which a law that steps resolve is a straight line."""
LOSES = 0.05
"""Change of velocity over a step by what the elimination loses, relative to the tolerance, with which it is left: 0.7 and more where
that holds steps back, 1e-3 and less in the examples at tolerances down to 1e-10."""
STEPS_AHEAD = 1e6
"""Steps still to come from which on jumps are looked at: half a minute or more."""
JUMPS = 8
"""Second differences that must be large: a force that changes its law makes two."""
PART = 1e-3
"""Of the largest acceleration that such a jump must be, so that an equation comes and goes: rounding of huge accelerations is less."""
GOVERNS = 0.03
"""Change of velocity over a step by such a jump of its acceleration, relative to the tolerance, that holds the steps back; 0.1 to 2
where it does."""


class Rounding:
    """Looks at what shortens the steps of a run.

    Parameters
    ----------
    dynamics : Dynamics
    rtol : float
        Relative tolerance of the integrator.
    start, end : floats
        Of the run, s.
    """

    def __init__(self, dynamics: Dynamics, rtol: float, start: float, end: float) -> None:
        self._dynamics, self._rtol, self._end = dynamics, rtol, end
        self._soon, self._later = _Stretch(start, SOON), _Stretch(start, APART)

    def look(self, work: Integration) -> str:
        """Look at the state reached, where that is due; why the run ends there, empty where it goes on.

        It goes on without elimination where that loses digits.  It ends where accelerations jump with the last digits of the
        coordinates, and these jumps govern the steps: the sentence names the acceleration, and the element that pulls hardest.
        """
        pace = self._soon.pace(work)
        if pace and work.eliminates and self._loses_digits(work, pace):
            work.eliminates = False
        pace = self._later.pace(work)
        return self._jumping(work, pace) if pace and self._end - work.t > STEPS_AHEAD * pace else ""

    def _loses_digits(self, work: Integration, pace: float) -> bool:
        """Whether the elimination's accelerations are so far from those of the whole system that this holds steps back."""
        found, off = np.empty(len(work.u)), []
        for t in self._along(work, WITHIN * pace, FEW):
            if ACCELERATE.call(t, address(found), address(self._dynamics.eliminated.table)):
                off.append(np.abs(found - self._dynamics.accelerate(t)[1]))
        self._dynamics.forget_pivots()
        return bool(off) and bool(np.any(pace * np.max(off, axis=0) > LOSES * self._tolerance(work)))

    def _jumping(self, work: Integration, pace: float) -> str:
        """A sentence on the acceleration whose jumps govern the steps; empty where none does."""
        jumps, tolerance = self._jumps(work, WITHIN * pace), self._tolerance(work)
        k = int(np.argmax(jumps / tolerance))
        if not jumps[k] * pace > GOVERNS * tolerance[k]:
            return ""
        likely = suspect(self._dynamics, work.t, work.q.copy(), work.u.copy())
        return (
            f"rounding governs the steps, {APART} of which cover {APART * pace:.3g} s: the last digits of the coordinates change "
            f"{acceleration_name(self._dynamics.system, k)} by {jumps[k]:.2g}{likely}; expected constraints that either repeat each "
            "other exactly or differ clearly, or solver bdf"
        )

    def _jumps(self, work: Integration, span: float) -> np.ndarray:
        """By how much each acceleration jumps, again and again, on a short way ahead; shape (n_u,)."""
        accelerations = np.zeros((INSTANTS, len(work.u)))
        for row, t in zip(accelerations, self._along(work, span, INSTANTS), strict=True):
            status, acceleration = self._dynamics.accelerate(t)
            if status == 0:
                row[:] = acceleration
        jumps = np.sort(np.abs(np.diff(accelerations, 2, axis=0)), axis=0)[-JUMPS]
        return np.where(jumps > PART * np.abs(accelerations).max(), jumps, 0.0)

    def _along(self, work: Integration, span: float, count: int) -> Iterator[float]:
        """Instants on a short way ahead; the state stands at each in turn."""
        q, u, dynamics = work.q.copy(), work.u.copy(), self._dynamics
        for ahead in np.linspace(0.0, span, count).tolist():
            dynamics.state.q[:], dynamics.state.u[:] = dynamics.system.of_body.moved(q, ahead * u), u
            yield work.t + ahead

    def _tolerance(self, work: Integration) -> np.ndarray:
        """Of velocities, shape (n_u,)."""
        tolerance: np.ndarray = work.atol[len(work.q) :] + self._rtol * np.abs(work.u)
        return tolerance


class _Stretch:
    """Steps from one look to the next."""

    def __init__(self, start: float, apart: int) -> None:
        self._t, self._steps, self._apart = start, 0, apart

    def pace(self, work: Integration) -> float:
        """The mean length of the steps since the last look, s; 0 where the next is not due."""
        taken, way = work.count("steps") - self._steps, work.t - self._t
        if taken < self._apart:
            return 0.0
        self._t, self._steps = work.t, work.count("steps")
        return way / taken
