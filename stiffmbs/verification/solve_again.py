"""Solving a prepared job once more with other settings, with as much work as one is willing to wait for."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..analyses.job import Job
from ..analyses.run import solved
from ..errors import StiffmbsError
from ..results.solution import Solution
from ..solve.settings import changed
from ..solve.trajectory import Grid, Outcome

LOOKS_AHEAD = 0.3
"""Part of what it is allowed after which a run that will not come to its end is given up."""


class OutOfTime(KeyboardInterrupt):
    """Ends a solver as the user's own interruption does: with what it has."""


class Deadline:
    """A watch that ends a run when its time is over, or when it is far from its end at a third of its time.

    The time may be any measure of effort that grows as the run goes on.

    Parameters
    ----------
    start, end : float
        Of the run, s.
    allowed : float
        Time to wait, s, or what `clock` tells.
    clock : callable
        The time that has gone by.
    """

    def __init__(
        self, start: float, end: float, allowed: float, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self._start, self._end, self._allowed = start, end, allowed
        self._clock, self._begun = clock, clock()
        self.passed = False

    def __call__(self, t: float) -> None:
        spent = self._clock() - self._begun
        done = (t - self._start) / (self._end - self._start)
        hopeless = spent > LOOKS_AHEAD * self._allowed and spent > 2 * done * self._allowed
        if spent > self._allowed or hopeless:
            self.passed = True
            raise OutOfTime


@dataclass(frozen=True)
class Again:
    """A run to compare with.

    Attributes
    ----------
    name : str
        What was done: ``bdf at rtol 1e-07``.
    solution : Solution or None
        None where it gave nothing.
    obstacle : str
        Why it did not come to the end; empty where it did.
    remark : str
        What the solver says of its steps; empty for nothing.
    blind : str
        What its steps go over though the first run has seen it; empty for nothing.
    at : ndarray of int
        Which of its instants are those of the first run.
    """

    name: str
    solution: Solution | None
    obstacle: str
    at: np.ndarray
    remark: str = ""
    blind: str = ""

    def reported(self, channel: str) -> np.ndarray:
        """A channel at the instants of the first run, as far as they were reached."""
        assert self.solution is not None
        return self.solution[channel][self.at]


def solve_again(
    job: Job, name: str, changes: dict[str, Any], times: np.ndarray, at: np.ndarray, allowed: float
) -> Again:
    """Solve with changed settings.

    Parameters
    ----------
    job : Job
    name : str
        For sentences.
    changes : dict
        Fields of the settings.
    times : ndarray
        Instants to report, s, the start first.
    at : ndarray of int
        Which of them are the first run's.
    allowed : float
        Evaluations of the job's equations that it may take: a count is the same on a machine that is busy.
    """
    if allowed <= 0:
        return Again(name, None, "not begun: no effort was left", at[:0])
    grid = Grid(job.grid.start, float(times[-1]), times)
    deadline = Deadline(grid.start, grid.end, allowed, job.evaluations)
    try:
        solution = solved(replace(job, settings=changed(job.settings, changes), grid=grid), deadline)
    except StiffmbsError as error:
        return Again(name, None, str(error), at[:0])
    obstacle = "" if solution.outcome is Outcome.DONE else solution.message
    if solution.outcome is Outcome.INTERRUPTED:
        if not deadline.passed:
            raise KeyboardInterrupt
        obstacle = f"given up at t = {solution.time[-1]:.4g} s: it would have taken more than {allowed:.2g} evaluations"
    how = solution.outcome.value
    remark = solution.message.removeprefix(how).removeprefix("; ") if solution.message.startswith(how) else ""
    return Again(name, solution, obstacle, at[at < len(solution.time)], remark)
