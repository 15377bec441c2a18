"""Steps of a simulation between instants at which its inputs jump: IDA starts anew at each of them."""

from __future__ import annotations

import numpy as np

from ..analyses.job import Job
from ..compile.inputs.features import InputFeatures
from ..describe.settings import RunSettings
from ..errors import SolverError
from ..solve.events.restart import just_after, just_before, restarted
from ..solve.ida.engine import Reached
from ..solve.ida.native_engine import NativeEngine
from ..solve.integrator import Integrator
from ..solve.settings import changed
from ..solve.trajectory import Grid

NO_PAUSE = 10**9
"""Steps after which IDA need not come back."""
PART, FINEST = 0.01, 1e-12
"""Part of the tolerance that starts are given, down to the finest.  Errors of starts add up: a cart-pendulum whose force jumps each ms
is off by 1.2e-6 m after 10 s at rtol 1e-8, and by 9e-9 with this part of it; one run without jumps is off by 3e-8."""


class StartedSteps:
    """Each of them a start of IDA's and the steps up to the next instant: one compiled call, where that serves.

    Parameters
    ----------
    job : Job
    q, u : ndarrays
        Memory of the present state.

    Attributes
    ----------
    compiled : Restarts or None
        The compiled starts.
    """

    def __init__(self, job: Job, q: np.ndarray, u: np.ndarray) -> None:
        self._dynamics, self._q, self._u = job.dynamics, q, u
        self._integrator = Integrator(job.dynamics, _finer(job.settings), memory="starts")
        engine = self._integrator.engine
        assert isinstance(engine, NativeEngine)
        self._engine, self.compiled = engine, engine.restarts(job.dynamics, q, u)
        self._features: InputFeatures | None = None

    def advance(self, t: float, end: float, features: InputFeatures) -> None:
        """Go on from the state at t, s, to a later time; the state is then the one there.

        Parameters
        ----------
        t, end : float
            s.
        features : InputFeatures
            Of the inputs around these times.

        Raises
        ------
        SolverError
            When it cannot be reached; the state is then as it was.
        """
        if not (self.compiled and self._quickly(t, end, features) and self.compiled.advance(t, end)):
            self._run(t, end)

    def _quickly(self, t: float, end: float, features: InputFeatures) -> bool:
        """Whether no breakpoint lies between; the integrator then sees the inputs."""
        if self._features is not features:
            self._engine.see_inputs(features, end - t)
            self._features = features
        between = features.breakpoints
        return not len(between) or not np.any((between >= just_before(t)) & (between <= just_after(end)))

    def _run(self, t: float, end: float) -> None:
        self._features = None  # the run sees the inputs up to its end alone
        self._engine.pause_after(NO_PAUSE)
        start = restarted(self._dynamics, t, self._q, self._u)
        for reached in self._integrator.run(start, Grid(t, end, np.array([end]))):
            last = sound(self._integrator, reached)
        self._q[:], self._u[:] = self._integrator.split(last.y)


def sound(integrator: Integrator, reached: Reached) -> Reached:
    """Where an integrator has come.

    Raises
    ------
    SolverError
        When it cannot go on.
    """
    integrator.reached = reached
    if reached.failure:
        raise SolverError(f"stopped at t = {reached.t:.9g} s: {reached.failure}")
    return reached


def _finer(settings: RunSettings) -> RunSettings:
    """The settings of a run with the tolerance of starts."""
    part = max(PART, min(1.0, FINEST / settings.rtol))
    absolute = None if settings.atol is None else part * settings.atol
    return changed(settings, {"rtol": part * settings.rtol, "atol": absolute})
