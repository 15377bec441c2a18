"""How a simulation goes from one instant to the next: with IDA's own steps, or by short runs of explicit solvers."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Protocol

import numpy as np

from ..analyses.job import Job
from ..errors import SolverError
from ..solve import SOLVERS
from ..solve.events.restart import just_after, restarted
from ..solve.ida.engine import Reached
from ..solve.ida.native_engine import NativeEngine
from ..solve.initial import InitialValues
from ..solve.integrator import Integrator
from ..solve.trajectory import Grid, Outcome
from .started_steps import StartedSteps, sound


class Stepper(Protocol):
    """Goes on from consistent values.

    Attributes
    ----------
    q, u : ndarrays
        The present state, overwritten by each step.
    """

    q: np.ndarray
    u: np.ndarray

    def advance(self, t: float) -> None:
        """Go on to a later time.

        Raises
        ------
        SolverError
            When it cannot be reached.
        """

    def jump(self) -> None:
        """Forget what is behind the present state, as inputs jump here."""

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Go on from another state."""


def stepper_of(job: Job, start: InitialValues, t: float) -> Stepper:
    """IDA's where bdf solves natively; short runs of any other solver."""
    if job.settings.solver == "bdf":
        integrator = Integrator(job.dynamics, job.settings)
        if isinstance(integrator.engine, NativeEngine):
            return ImplicitSteps(job, integrator, start, t)
    return ShortRuns(job, start, t)


class ImplicitSteps:
    """IDA's own steps, as long as they would be in one run, and states within the last of them.

    Behind a jump of inputs the first step of a simulation ends a step of IDA's too, as inputs mostly jump again there.

    Parameters
    ----------
    job : Job
    integrator : Integrator
        With the native engine.
    start : InitialValues
    t : float
        s.
    """

    def __init__(self, job: Job, integrator: Integrator, start: InitialValues, t: float) -> None:
        self._job, self._dynamics, self._integrator = job, job.dynamics, integrator
        engine = integrator.engine
        assert isinstance(engine, NativeEngine)
        self._engine, self._end = engine, t
        self._look_through(t)
        self._begin(start, t)
        self._present, self.q, self.u = t, start.q.copy(), start.u.copy()

    @cached_property
    def _started(self) -> StartedSteps:
        return StartedSteps(self._job, self.q, self.u)

    def _look_through(self, t: float) -> None:
        """Have the inputs looked through once for all steps that follow."""
        if t >= self._end:
            self._end = t + self._job.settings.duration
            self._features = self._dynamics.input_features(t, self._end)

    def _begin(self, start: InitialValues, t: float) -> None:
        self._t, self._jumped, self._ended = t, False, False
        self._engine.pause_after(1)
        self._steps: Iterator[Reached] = self._integrator.run(start, Grid(t, self._end, None))

    def advance(self, t: float) -> None:
        """See `Stepper`."""
        if self._jumped or self._ended:
            self._look_through(self._t)
            if self._jumped and t <= self._end:
                if t > just_after(self._t):
                    self._started.advance(self._t, t, self._features)
                self._t, self._present, self._jumped, self._ended = t, t, False, True
                return
            self._begin(restarted(self._dynamics, self._t, self.q, self.u), self._t)
        while self._t < t:
            reached = next(self._steps, None)
            if reached is None:  # the end of what was looked through
                self._look_through(self._t)
                self._begin(
                    restarted(self._dynamics, self._t, *self._integrator.split(self._engine.at(self._t))), self._t
                )
            else:
                self._t = sound(self._integrator, reached).t
        self.q[:], self.u[:] = self._integrator.split(self._engine.at(t))
        self._present = t

    def jump(self) -> None:
        """See `Stepper`."""
        self._t, self._jumped = self._present, True

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """See `Stepper`."""
        self._t, self._present, self._jumped = t, t, True
        self.q[:], self.u[:] = q, u


class ShortRuns:
    """A run from each instant to the next, of a solver that needs no history.

    Parameters
    ----------
    job : Job
    start : InitialValues
    t : float
        s.
    """

    def __init__(self, job: Job, start: InitialValues, t: float) -> None:
        self._job, self._start, self._t = job, start, t
        self._settings, self._end = job.settings, t
        self.q, self.u = start.q.copy(), start.u.copy()

    def advance(self, t: float) -> None:
        """See `Stepper`."""
        if t > self._t:
            if t > self._end:  # inputs are looked through once for all steps that follow
                self._end = t + self._settings.duration
                self._job.dynamics.input_features(self._t, self._end)
            grid = Grid(self._t, t, np.array([self._t, t]))
            run = SOLVERS[self._settings.solver].solve
            found = run(self._job.dynamics, self._start, grid, self._settings, lambda _: None)
            if found.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            if found.outcome is not Outcome.DONE:
                raise SolverError(found.message)
            self.restart(t, found.q[-1], found.u[-1])

    def jump(self) -> None:
        """See `Stepper`."""
        self.restart(self._t, self.q, self.u)

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """See `Stepper`."""
        self._t, self._start = t, restarted(self._job.dynamics, t, q, u)
        self.q[:], self.u[:] = self._start.q, self._start.u
