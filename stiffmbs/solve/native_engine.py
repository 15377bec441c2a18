"""The engine of `bdf` that drives IDA natively: no Python inside the step loop."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.equations import Equations
from ..compile.state import State
from ..compile.system import PLANAR
from .engine import Reached
from .initial import POSITIONS, VELOCITIES
from .sundials.ida import NativeIda
from .sundials.status import Status
from .trajectory import History

ROWS_OF_STEPS = 1000
"""Room for rows in one call that reports every step."""
MANY_FAILURES, EASED, EASIEST = 0.2, 100.0, 0.33
"""Part of the steps in which Newton's iteration may fail before less is asked of it, by that factor, up to that part."""
RENEWAL, RENEWED_UP_TO = 0.05, 90
"""Change of cj at which the iteration matrix is made anew, for so many unknowns: there a matrix costs no more than a
residual (a third fewer residuals than with IDA's own 0.25)."""


class NativeEngine:
    """IDA through its C interface (`NativeIda`); the contract is in `stiffmbs.solve.engine.Engine`."""

    def __init__(self, equations: Equations, state: State, rtol: float, atol: np.ndarray, max_step: float) -> None:
        reported = np.concatenate([equations.at["q"], equations.at["u"]])
        renewal = RENEWAL if equations.n <= RENEWED_UP_TO else None
        self._ida = NativeIda(equations, state, rtol, atol, max_step=max_step, renewal=renewal, reported=reported)
        self._width, self._equations = len(reported), equations
        self._newton = 0.0
        self._counted = {"steps": 0, "convergence_failures": 0}

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float) -> None:
        """Start, or start anew, at consistent values."""
        self._newton = newton
        self._ida.leave_to_newton(newton)
        self._ida.begin(t, y, yp)

    def _ease_newton(self) -> None:
        """Ask less of Newton's iteration when it failed in many steps of a call: rounding may keep it from settling."""
        counted = self._ida.statistics()
        steps = counted["steps"] - self._counted["steps"]
        failures = counted["convergence_failures"] - self._counted["convergence_failures"]
        self._counted = counted
        if failures > MANY_FAILURES * steps and self._newton < EASIEST:
            eased = min(EASIEST, EASED * self._newton)
            self.begin(self._ida.t, self._ida.y.copy(), self._ida.yp.copy(), eased)  # IDA reads it at a start alone

    def to_times(self, times: np.ndarray, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report at times up to there; ends early at an event or a failure."""
        status, served = Status.GOING, 0
        while status is Status.GOING:
            times = times[served:]
            rows = np.empty((len(times), self._width))
            served, status = self._ida.advance(times, stop, rows)
            yield self._reached(times[:served], rows[:served], status)
            if status is Status.GOING:
                self._ease_newton()

    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report each step; ends early at an event or a failure."""
        status = Status.GOING
        while status is Status.GOING:
            times, rows = np.empty(ROWS_OF_STEPS), np.empty((ROWS_OF_STEPS, self._width))
            served, status = self._ida.steps(stop, times, rows)
            yield self._reached(times[:served], rows[:served], status)
            if status is Status.GOING:
                self._ease_newton()

    def _reached(self, times: np.ndarray, rows: np.ndarray, status: Status) -> Reached:
        failure = f"{self._ida.failure()}{self._worst()}" if status is Status.FAILED else ""
        return Reached(times, rows, self._ida.t, self._ida.y, status is Status.ROOT, failure)

    def _worst(self) -> str:
        """Where the last step's error, or the last correction of Newton's iteration, was largest; nothing where that is not known."""
        unknown, size = self._ida.worst()
        if not 0.0 < size < np.inf:
            return ""
        at, bodies = self._equations.at, self._equations.system.bodies
        for name, labels in (("q", POSITIONS), ("u", VELOCITIES)):
            for k in np.flatnonzero(at[name] == unknown):
                return f"; the largest error was in {bodies[k // PLANAR]}.{labels[k % PLANAR]}"
        return ""

    def statistics(self) -> dict[str, int | float]:
        """Counters since the first start."""
        return dict(self._ida.statistics())

    def history(self) -> History:
        """Ends of the steps and their orders."""
        return History(self._ida.history.t, self._ida.history.order)
