"""State about which a model is linearised."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...dynamics.algebraic_states import failure
from ...errors import SolverError
from ...model.model_data import ModelData
from ...model.settings import RunSettings
from ...redundancy.redundancy import Redundancy
from ...tuning import in_use
from ..job import Runnable, prepare
from ..start_from import StartFrom
from .kink import Instant


@dataclass(frozen=True)
class AtState(Instant):
    """Model at a time, s, and the settings of the run to it."""

    data: ModelData
    redundancy: Redundancy
    settings: RunSettings


def at_state(
    model: Runnable,
    settings: RunSettings | None = None,
    at: float | None = None,
    start_from: StartFrom | None = None,
    **changes: object,
) -> AtState:
    """Return a model at its start, or at a time of its motion, s; `start_from` and changes of settings as for `stiffmbs.run`.

    Raises InputError, AssemblyError as for `stiffmbs.run`. Raises SolverError if the run does not reach that time, or
    no accelerations are found there.
    """
    job = prepare(model, settings, start_from, **changes)
    t = job.grid.start
    state = job.dynamics.state
    state.q[:], state.u[:] = job.start.q, job.start.u
    if at is not None and at != t:
        job = prepare(model, settings, start_from, **{**changes, "duration": at - t, "points": 2})
        trajectory = job.integrate()
        if not np.isclose(trajectory.t[-1], at):
            raise SolverError(f"no state was found at t = {at:g} s: {trajectory.message}")
        t, state = at, job.dynamics.state
        state.q[:], state.u[:] = trajectory.q[-1], trajectory.u[-1]
    with in_use(job.settings.tuning):
        if t != job.grid.start:
            job.dynamics.assemble(t)
            job.dynamics.correct_velocities(t)
        status, acceleration = job.dynamics.accelerate(t)
    if status < 0:
        raise SolverError(f"no accelerations were found at t = {t:g} s: {failure(job.dynamics, status, t)}")
    return AtState(job.dynamics, t, acceleration, job.data, job.redundancy, job.settings)
