"""Runs that yield intermediate solutions."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Unpack

import numpy as np

from ..analyses.job import Job, Runnable, data_of, prepare, settings_of
from ..analyses.start_from import StartFrom
from ..errors import InputError
from ..model.settings import DEFAULT_POINTS, RunSettings, Settings, takes_settings
from ..results.solution import Solution
from ..solve.settings import changed
from ..solve.trajectory import Ending, Outcome
from .solved_states import solution_of
from .stepping import stepper_of

SHARE = 5.0
"""Least ratio of the time of solving to the time of reporting, so that long runs are reported less often."""
STILL_SOLVING = "still solving"


@takes_settings
def follow(
    model: Runnable,
    every: float = 0.5,
    settings: RunSettings | None = None,
    start_from: StartFrom | None = None,
    **changes: Unpack[Settings],
) -> Iterator[Solution]:
    """Solve a model, and yield the solution so far from time to time, finally the whole solution.

    bdf and radau keep their history, as in `stiffmbs.run`; other solvers restart at each output instant.  Notes and
    verification, as of `stiffmbs.run`, are omitted.

    Parameters
    ----------
    model : Model, Scene, str or Path
    every : float
        Least wall-clock time between two solutions, s.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    start_from : Solution, str, Path or SavedState, optional
        As for `stiffmbs.run`.
    **changes
        Fields of the settings to change.

    Yields
    ------
    Solution
        Results from the start to the current time; the last one is complete, or ends where the solver stopped.

    Raises
    ------
    InputError
        If the model or a setting is invalid.
    AssemblyError
        If no consistent start is found.

    Examples
    --------
    >>> for solution in stiffmbs.follow("examples/cart_pendulum.yaml"):
    ...     print(solution.t[-1], solution["cart.x"][-1])
    """
    if not every >= 0:
        raise InputError(f"follow: found every = {every}, expected a time of 0 s or more")
    data = data_of(model)
    chosen = settings_of(data, settings, changes)
    job = prepare(data, chosen, start_from)
    if job.subsystems:
        job = prepare(data, changed(chosen, {"presolve": False}), start_from)
    return _followed(job, every)


def _followed(job: Job, every: float) -> Iterator[Solution]:
    grid = job.grid
    grid = grid.before_breakpoints(job.dynamics.input_features(grid.start, grid.end))
    instants = grid.times if grid.times is not None else np.linspace(grid.start, grid.end, DEFAULT_POINTS)
    stepper = stepper_of(job, job.start, job.grid.start)
    q = np.empty((len(instants), len(job.start.q)))
    u = np.empty((len(instants), len(job.start.u)))
    lengths = np.zeros(len(instants))
    q[0], u[0] = job.start.q, job.start.u
    reported, pause, solved = time.monotonic(), every, 1
    with Ending() as ending:
        for k in range(1, len(instants)):
            stepper.advance(float(instants[k]))
            q[k], u[k], lengths[k] = stepper.q, stepper.u, stepper.length
            solved = k + 1
            begun = time.monotonic()
            if begun - reported >= pause and solved < len(instants):
                found = instants[:solved], (q[:solved], u[:solved]), lengths
                yield solution_of(job, *found, project=True, outcome=Outcome.STOPPED, message=STILL_SOLVING)
                reported = time.monotonic()
                pause = max(every, SHARE * (reported - begun))
    found = instants[:solved], (q[:solved], u[:solved]), lengths
    yield solution_of(job, *found, project=True, outcome=ending.outcome, message=ending.message)
