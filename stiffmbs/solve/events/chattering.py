"""Detection of runs that would not end: chattering forces, accumulating events and vanishing steps."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from ...compile.written_values import writer
from ...errors import ChatteringError, SolverError
from ..dynamics import Dynamics
from .discontinuity import LARGER_MOVE, jumping, sliding

WINDOW, TRUSTED_EVENTS = 250, 1000
"""Events over which their rate is measured, and number of events above which its growth is trusted."""
TOO_MANY, AT_LEAST = 1e6, 1e4
"""Expected further events at which a run is stopped, and their least number at which growth is considered."""
LEAST_POWER, LARGEST_POWER = 0.8, 2.0
"""Bounds of the power of the number of events with which their rate grows in an exponentially driven motion.  Bounces
of a ball that comes to rest have larger powers, and end."""
STEPS_SEEN, STEPS_AHEAD = 500_000, 2e8
"""Steps over which the rate of a run is measured, and expected further steps at which it is stopped."""
STAYS_WITHIN, STAYS_WITHIN_AT_MOST = 1e3, 1e-2
"""Distance from a jump at which a state is taken to stay there: relative to rtol, and its upper bound."""


class Chattering:
    """Monitor of one run of an integrator.

    Parameters
    ----------
    dynamics : Dynamics
    end : float
        End of the run, s.
    rtol : float
        Relative tolerance of the integrator.
    """

    def __init__(self, dynamics: Dynamics, end: float, rtol: float) -> None:
        self._dynamics, self._end = dynamics, end
        self._reach = min(max(LARGER_MOVE, STAYS_WITHIN * rtol), STAYS_WITHIN_AT_MOST)
        self._any = dynamics.system.n_event_functions > 0
        self._events: deque[float] = deque(maxlen=2 * WINDOW + 1)
        self._count = 0
        self._mark: tuple[float, int] | None = None

    def begin(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Check the state from which the integrator starts.

        Raises
        ------
        ChatteringError
            If a force drives the motion back from both sides of its discontinuity; names the element.
        """
        if self._any:
            self.refuse(t, sliding(self._dynamics, t, q, u))

    def look(self, t: float, q: np.ndarray, u: np.ndarray, steps: int) -> None:
        """Check a state after `steps` steps of the run.

        Raises
        ------
        ChatteringError
            If a force drives the motion back from both sides of its discontinuity.
        SolverError
            If the steps are too short to reach the end.
        """
        if self._any:
            self.refuse(t, sliding(self._dynamics, t, q, u, self._reach))
        since, before = self._mark or (t, steps)
        if steps - before < STEPS_SEEN:
            self._mark = since, before
            return
        self._mark = t, steps
        pace = (t - since) / (steps - before)
        if self._end - t > STEPS_AHEAD * pace:
            raise SolverError(
                f"stopped at t = {t:.9g} s: the last {steps - before} steps have covered {t - since:.3g} s, and at least "
                f"{STEPS_AHEAD:.0e} more would follow to the end: expected a motion without singularities (a force that divides by "
                "a velocity at rest, a jump without a breakpoint, a mechanism that jams)"
            )

    def note_event(self, t: float, q: np.ndarray, u: np.ndarray, event_function: int) -> None:
        """Record an event at a state; the number of the event function is negative if it is unknown.

        Raises
        ------
        ChatteringError
            When events accumulate so that the run would not end; names the element.
        """
        self._count += 1
        self._events.append(t)
        if self._count % WINDOW or len(self._events) <= 2 * WINDOW:
            return
        first, middle, last = (self._events[k] for k in (0, WINDOW, 2 * WINDOW))
        if self._to_come(middle - first, last - middle) > TOO_MANY:
            self.refuse(t, jumping(self._dynamics, t, q, u))
            name = (
                f"'{writer(self._dynamics.system, 'event_function', event_function)}'"
                if event_function >= 0
                else "a force"
            )
            raise ChatteringError(
                f"stopped at t = {t:.9g} s: {name} changes its law back and forth ever faster, {self._count} times so far and once in "
                f"{(last - middle) / WINDOW:.3g} s: the run would come to no end; expected a force without a jump where the motion comes "
                "to rest, a switch with hysteresis, or a force that does not drive the motion beyond all bounds"
            )

    def _to_come(self, before: float, last: float) -> float:
        """Return the expected number of events up to the end, from the durations of the last two windows.

        With a rate f ~ N of events N, their number grows as exp(f t/N).
        """
        steady = (self._end - self._events[-1]) / max(last, 1e-300) * WINDOW
        if steady < AT_LEAST or self._count < TRUSTED_EVENTS or last <= 0.0:
            return steady
        power = math.log(before / last) / math.log((self._count - 0.5 * WINDOW) / (self._count - 1.5 * WINDOW))
        growing = LEAST_POWER < power < LARGEST_POWER
        return self._count * math.exp(min(steady / self._count, 100.0)) if growing else steady

    def refuse(self, t: float, event_functions: np.ndarray) -> None:
        """Raise a ChatteringError that names the first of some event functions, if there are any."""
        if len(event_functions):
            raise ChatteringError(f"stopped at t = {t:.9g} s: {jump_sentence(self._dynamics, int(event_functions[0]))}")


def jump_sentence(dynamics: Dynamics, event_function: int) -> str:
    """Return a sentence on a chattering force."""
    return (
        f"'{writer(dynamics.system, 'event_function', event_function)}' jumps back and forth, as a force does that changes its "
        "sign where the motion comes to rest: no motion follows it from there on; expected a force that is steep "
        "there, without a jump: joint_friction with its smooth_velocity, or tanh(v/0.001) in place of sign(v)"
    )
