"""Measurements of a solver configuration at settings from loose to tight, against a reference."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ..analyses.job import Job, prepare, up_to_a_fault
from ..errors import InputError, StiffmbsError
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..results.channels import channels_of
from ..solve.missing_rows import reported
from ..solve.settings import near_constraints
from ..solve.trajectory import Outcome, Trajectory
from ..tuning import in_use
from ..verification.solve_again import Deadline, uninterrupted
from .at_error import LINE, Row
from .plan import Entry
from .reference import Reference, Tell

Found = TypeVar("Found")


@dataclass(frozen=True)
class Timing:
    """Way in which solutions are timed. `once`: time above which a solution is timed only once, s."""

    once: float = 0.2


TIMING = Timing()


@dataclass
class Timed:
    """Timed solution: a function that solves it again (None for slow ones), and its times so far, s."""

    solve: Callable[[], object] | None
    seconds: list[float]

    def measure(self) -> None:
        """Time the solution once more, unless it is slow."""
        if self.solve is not None:
            self.seconds.append(seconds_of(self.solve)[0])

    @property
    def median(self) -> float:
        """Return the median of the times, s."""
        return statistics.median(self.seconds)


def seconds_of(solve: Callable[[], Found]) -> tuple[float, Found]:
    """Return the processor time of a solution, which excludes other programs, and the solution."""
    begun = time.process_time()
    found = solve()
    return time.process_time() - begun, found


def take_turns(timed: Sequence[Timed], rounds: Iterable[int]) -> None:
    """Time all solutions in each round, forwards and backwards in turn, and drop the first times, with cold caches.

    The neighbours of a solution differ between both orders, so that none always follows other code with cold caches.
    """
    for k in rounds:
        for one in timed[:: -1 if k % 2 else 1]:
            one.measure()
    for one in timed:
        del one.seconds[: len(one.seconds) > 1]


ENOUGH_SETTINGS = 2
"""Number of successive settings far more accurate than required after which a sweep ends."""
WARM_UP = 1e-3
"""Part of the duration that is solved before a timed run, to compile code and set up caches."""


@dataclass
class Point(Timed):
    """Solver configuration at a setting, with its errors by measure, or a message if it failed."""

    entry: Entry
    setting: str
    errors: Mapping[str, float]
    steps: int
    message: str = ""

    def row(self) -> Row:
        """Return the measurement as a row."""
        seconds = self.median if self.seconds else np.nan
        return Row(self.entry.name, self.setting, self.errors, seconds, self.steps, self.message)


@dataclass(frozen=True)
class Sweep:
    """Common data of the measurements, with their time limit."""

    model: ModelData
    settings: RunSettings
    reference: Reference
    longest: float  # time limit of a run, s
    tell: Tell  # called with a line of text on the progress

    def points(self, entry: Entry, values: Sequence[float], target: tuple[str, float] | None = None) -> Iterator[Point]:
        """Yield points from loose to tight, up to a run beyond the time limit, or to two settings beyond the target.

        `values`: tolerances or steps, the loosest first. `target`: a measure, and the required error.
        """
        beyond = 0
        for value in values:
            setting = entry.setting(value)
            self.tell(f"{entry.name}, {setting}")
            try:
                job = prepare(self.model, entry.at(self.settings, value))
                _warm_up(job)
                point, given_up = self._first(job, entry, setting, value == values[0])
            except StiffmbsError as error:
                yield Point(None, [], entry, setting, {}, 0, str(error))
                if isinstance(error, InputError):
                    return
                continue
            yield point
            if target is not None and not point.message:
                beyond = beyond + 1 if point.errors[target[0]] < target[1] / LINE.window else 0
            if given_up or beyond == ENOUGH_SETTINGS:
                return

    def _first(self, job: Job, entry: Entry, setting: str, compiles: bool) -> tuple[Point, bool]:
        """Return the first point at a setting, timed again after possible compilation, and True if it took too long."""
        deadline = Deadline(job.grid.start, job.grid.end, self.longest)
        seconds, trajectory = seconds_of(lambda: job.integrate(deadline))
        if compiles and seconds >= TIMING.once and trajectory.outcome is Outcome.DONE:
            seconds, _ = seconds_of(lambda: uninterrupted(job.integrate()))
        uninterrupted(trajectory, deadline)
        steps = int(trajectory.statistics.get("steps", 0))
        if deadline.passed:
            message = f"aborted at t = {trajectory.t[-1]:.4g} s: it would take more than {self.longest:g} s"
            return Point(None, [], entry, setting, {}, steps, message), True
        trajectory = up_to_a_fault(job.dynamics.system, trajectory)
        message = "" if trajectory.outcome is Outcome.DONE else trajectory.message
        errors = {} if message else self._errors(job, trajectory)
        if not message and not errors:
            message = "some output times have no accelerations and reactions"
        solve = (lambda: uninterrupted(job.integrate())) if seconds < TIMING.once and not message else None
        return Point(solve, [] if message else [seconds], entry, setting, errors, steps, message), False

    @np.errstate(all="ignore")  # numbers of a diverged run overflow
    def _errors(self, job: Job, trajectory: Trajectory) -> dict[str, float]:
        """Return the errors by measure; empty if some output instants have no solution."""
        with in_use(job.settings.tuning):
            rows, _ = reported(job.dynamics, trajectory, near_constraints(job.settings), job.settings.rtol)
        if len(rows.t) < len(self.reference.solution.time):
            return {}
        return self.reference.errors(channels_of(job.data, job.dynamics.system, rows))


def _warm_up(job: Job) -> None:
    start, end = job.grid.start, job.grid.end
    until = start + WARM_UP * (end - start)
    uninterrupted(job.varied(times=np.array([start, until])).integrate())
