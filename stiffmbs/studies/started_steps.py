"""Steps of a simulation between jumps of its inputs, with a restart of IDA at each of them."""

from __future__ import annotations

import numpy as np

from ..analyses.job import Job
from ..compile.inputs.features import InputFeatures
from ..errors import SolverError
from ..model.settings import RunSettings
from ..solve.events.restart import just_after, just_before, restarted
from ..solve.ida.engine import Reached
from ..solve.ida.native_engine import NativeEngine
from ..solve.integrator import Integrator
from ..solve.settings import changed
from ..solve.trajectory import Grid

PART, FINEST = 0.01, 1e-12
"""Part of the tolerance that restarts get, and the finest tolerance; errors of restarts accumulate."""


class StartedSteps:
    """Restarts of IDA, each with the steps to the next instant, in one compiled call if possible.

    Parameters
    ----------
    q, u : ndarrays
        Memory of the current state.

    Attributes
    ----------
    compiled : Restarts or None
        Compiled restarts.
    """

    def __init__(self, job: Job, q: np.ndarray, u: np.ndarray) -> None:
        self._dynamics, self._q, self._u = job.dynamics, q, u
        self._integrator = Integrator(job.dynamics, _finer(job.settings), memory="starts")
        engine = self._integrator.engine
        assert isinstance(engine, NativeEngine)
        self._engine, self.compiled = engine, engine.restarts(job.dynamics, q, u)
        self._features: InputFeatures | None = None

    def advance(self, t: float, end: float, features: InputFeatures) -> None:
        """Advance the state from time t to a later time.

        `t`, `end`: times, s. `features`: features of the inputs around these times. Raises SolverError if the end
        cannot be reached; the state is then unchanged.
        """
        if not (self.compiled and self._quickly(t, end, features) and self.compiled.advance(t, end)):
            self._run(t, end)

    def _quickly(self, t: float, end: float, features: InputFeatures) -> bool:
        """Return True if no breakpoint lies between; the integrator then has the inputs."""
        if self._features is not features:
            self._engine.see_inputs(features, end - t)
            self._features = features
        between = features.breakpoints
        return not len(between) or not np.any((between >= just_before(t)) & (between <= just_after(end)))

    def _run(self, t: float, end: float) -> None:
        self._features = None  # the run has the inputs up to its end only
        self._engine.pause_after(np.iinfo(np.int32).max)  # never
        start = restarted(self._dynamics, t, self._q, self._u)
        for reached in self._integrator.run(start, Grid(t, end, np.array([end]))):
            last = sound(self._integrator, reached)
        self._q[:], self._u[:] = self._integrator.split(last.y)


def sound(integrator: Integrator, reached: Reached) -> Reached:
    """Return the state that an integrator has reached. Raises SolverError if the integrator fails."""
    integrator.reached = reached
    if reached.failure:
        raise SolverError(f"stopped at t = {reached.t:.9g} s: {reached.failure}")
    return reached


def _finer(settings: RunSettings) -> RunSettings:
    """Return the settings of a run with the tolerance of restarts."""
    part = max(PART, min(1.0, FINEST / settings.rtol))
    absolute = None if settings.atol is None else part * settings.atol
    return changed(settings, {"rtol": part * settings.rtol, "atol": absolute})
