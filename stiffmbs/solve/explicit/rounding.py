"""Steps that follow rounding: accelerations that jump with the last digits of the coordinates.

Where constraints repeat each other but for 1e-8, J M^-1 J' holds 1e-16: its pivots are rounding, and an equation counts at one state
and not at the next.  The error estimate sees a jump of the acceleration and shortens steps until a jump within one meets the tolerance.
"""

from __future__ import annotations

import numpy as np

from ..dynamics import Dynamics
from ..suspect import acceleration_name, suspect
from .integration import Integration

APART = 20_000
"""Steps from one look to the next."""
STEPS_AHEAD = 1e6
"""Steps still to come from which on a run is looked at: half a minute or more."""
INSTANTS, WITHIN = 64, 0.01
"""Instants at which accelerations are compared, within such a part of a step, over which a law that steps resolve is a straight line."""
JUMPS = 8
"""Second differences that must be large: a force that changes its law makes two."""
PART = 1e-3
"""Of the largest acceleration that such a jump must be, so that an equation comes and goes: rounding of huge accelerations is less."""
GOVERNS = 0.03
"""Change of velocity over a step by such a jump of its acceleration, relative to the tolerance, that holds the steps back; 0.1 to 2
where it does."""


class Rounding:
    """Looks at a run whose steps are too short to arrive soon.

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
        self._t, self._steps = start, 0

    def look(self, work: Integration) -> str:
        """Look at the state reached, where that is due; why the run ends there, empty where it goes on.

        It ends where accelerations jump with the last digits of the coordinates, and these jumps govern the steps.  The
        sentence names the acceleration, and the element that pulls hardest.
        """
        taken = work.count("steps") - self._steps
        if taken < APART:
            return ""
        way, self._t, self._steps = work.t - self._t, work.t, work.count("steps")
        if (self._end - work.t) * taken < STEPS_AHEAD * way:
            return ""
        pace = way / taken
        jumps = self._jumps(work, WITHIN * pace)
        tolerance = work.atol[len(work.q) :] + self._rtol * np.abs(work.u)
        k = int(np.argmax(jumps / tolerance))
        if not jumps[k] * pace > GOVERNS * tolerance[k]:
            return ""
        likely = suspect(self._dynamics, work.t, work.q.copy(), work.u.copy())
        return (
            f"rounding governs the steps, the last {taken} of which have covered {way:.3g} s: the last digits of the coordinates change "
            f"{acceleration_name(self._dynamics.system, k)} by {jumps[k]:.2g}{likely}; expected constraints that either repeat each "
            "other exactly or differ clearly, or solver bdf"
        )

    def _jumps(self, work: Integration, span: float) -> np.ndarray:
        """By how much each acceleration jumps, again and again, on a short way ahead; shape (n_u,)."""
        dynamics, q, u = self._dynamics, work.q.copy(), work.u.copy()
        accelerations = np.zeros((INSTANTS, len(u)))
        for row, ahead in zip(accelerations, np.linspace(0.0, span, INSTANTS), strict=True):
            dynamics.state.q[:], dynamics.state.u[:] = dynamics.system.of_body.moved(q, ahead * u), u
            status, acceleration = dynamics.accelerate(work.t + ahead)
            if status == 0:
                row[:] = acceleration[: len(u)]
        jumps = np.sort(np.abs(np.diff(accelerations, 2, axis=0)), axis=0)[-JUMPS]
        return np.where(jumps > PART * np.abs(accelerations).max(), jumps, 0.0)
