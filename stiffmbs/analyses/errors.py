"""Errors of a run: recording of its steps, and the estimate from them or from a second run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..results.estimate import ErrorEstimate
from ..solve.settings import changed, traits_of
from ..solve.trajectory import Outcome, Trajectory
from ..tuning import in_use

if TYPE_CHECKING:
    from ..results.solution import Solution
    from .job import Job

ASK = "--errors, or errors: true in run, estimates it"


def recording(job: Job) -> Job:
    """Return a job whose implicit steps are recorded: always if its errors are to be estimated, else up to some work."""
    from ..error_estimate.parameters import ESTIMATE

    most = {True: np.inf, None: ESTIMATE.work, False: 0.0}[job.settings.errors]
    return replace(job, grid=replace(job.grid, recorded=most))


def assessed(job: Job, trajectory: Trajectory, solution: Solution) -> Solution:
    """Return the results of a job with an estimate of their errors, or a sentence on why there is none."""
    traits = traits_of(job.settings)
    if not job.grid.recorded or len(solution.time) < 2 or solution.outcome is Outcome.INTERRUPTED or traits.exact:
        return solution
    with in_use(job.settings.tuning), np.errstate(all="ignore"):
        if trajectory.recorded:
            from ..error_estimate.estimate import estimated

            return estimated(
                solution, job.data, job.dynamics, job.start, job.subsystems, trajectory, job.settings
            )
        if traits.fixed_steps or job.dynamics.system.sampled.any():
            return _without(solution, "not estimated; --verify compares with other runs")
        if job.settings.errors:
            from ..error_estimate.second_run import compared

            return compared(solution, job)
    return _without(solution, f"not estimated: {_reason(trajectory)}; {ASK}")


def _reason(trajectory: Trajectory) -> str:
    steps = trajectory.statistics.get("steps", 0)
    if trajectory.statistics.get("jacobians") and "projected" not in trajectory.solver:
        return f"the run has many steps ({steps})"
    return "that takes a second run for explicit steps"


def _without(solution: Solution, sentence: str) -> Solution:
    return replace(solution, estimate=ErrorEstimate("none", sentence))
