"""Quasi-static analysis: an equilibrium at each output instant (Adams: SIMULATE/STATIC with END and STEPS)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Unpack

import numpy as np

from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import Dynamics
from ..equilibria.equilibrium import Equilibrium, find_equilibrium
from ..errors import AssemblyError, SolverError
from ..model.scene import Scene
from ..model.settings import RunSettings, Settings, takes_settings
from ..results.solution import Solution
from ..tuning import in_use
from .job import Job, Runnable, data_of, prepare
from .solution_at_rest import solution_at_rest


@takes_settings
def quasi_static(model: Runnable, settings: RunSettings | None = None, **changes: Unpack[Settings]) -> Solution:
    """Compute static equilibria at all output instants, each from the pose of the previous one.

    Forces, drives and tables of time are assumed to change slowly: forces that depend on velocities have no effect.

    Parameters
    ----------
    model : Model, Scene, str or Path
    settings : RunSettings, optional
        Settings with the output instants; by default those of the scene.
    **changes
        Fields of the settings to change.

    Returns
    -------
    Solution
        All channels over the output instants.

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        If no equilibrium is found; the message names the instant.
    """
    data = data_of(model)
    if isinstance(data, Scene):
        data = data.model_copy(update={"start": "described"})
    job = prepare(data, settings, **changes)
    times = job.grid.times if job.grid.times is not None else np.linspace(job.grid.start, job.grid.end, 101)
    found = [*equilibria_over_time(job, times)]
    q, u = (np.array([getattr(each, name) for each in found]) for name in ("q", "u"))
    moves = sum(each.moves for each in found)
    solver = {"name": "quasi_static", "moves": moves, "imbalance": max(each.imbalance for each in found)}
    return solution_at_rest(job, times, q, u, f"{len(times)} equilibria after {moves} moves", (), solver)


def equilibria_over_time(job: Job, times: np.ndarray) -> Iterator[Equilibrium]:
    """Yield the equilibria at given times, s, each from the pose of the previous one; the state is set to it.

    Raises AssemblyError, SolverError as for `quasi_static`.
    """
    job.dynamics.state.q[:] = job.start.q
    for t in times:
        with in_use(job.settings.tuning):
            found = _next(job.dynamics, float(t))
        yield found


def _next(dynamics: Dynamics, t: float) -> Equilibrium:
    """Find the equilibrium at a given time from the current pose, and move the state to it."""
    status = dynamics.assemble(t)
    if status < 0:
        raise AssemblyError(f"t = {t:g} s: the constraints do not meet: {failure(dynamics, status, t)}")
    try:
        return find_equilibrium(dynamics, t)
    except SolverError as error:
        raise SolverError(f"t = {t:g} s: {error}") from None
