"""Rerun of a prepared job with other settings and limited effort."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ..analyses.job import Job
from ..analyses.run import solved
from ..errors import StiffmbsError
from ..model.settings import RunSettings
from ..results.solution import Solution
from ..solve.settings import changed, traits_of
from ..solve.trajectory import Outcome, Trajectory
from .parameters import VERIFICATION

EXPLICIT: dict[str, object] = {"solver": "projected", "scheme": "dop853", "projection": True}
BDF: dict[str, object] = {"solver": "bdf", "formulation": "SI2"}
RADAU: dict[str, object] = {"solver": "radau", "formulation": "SI2"}
"""Integrators for the comparison with another formula."""


class OutOfTime(KeyboardInterrupt):
    """Interruption of a solver that has exceeded its effort."""


class Deadline:
    """Watch that stops a run if it exceeds its effort, or is going to after a third of it.

    The effort may be any measure that grows during the run. `start`, `end`: of the run, s. `allowed`: allowed effort,
    in units of `clock` (s by default). `clock`: return the effort so far.
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
        hopeless = spent > VERIFICATION.looks_ahead * self._allowed and spent > 2 * done * self._allowed
        if spent > self._allowed or hopeless:
            self.passed = True
            raise OutOfTime


@dataclass(frozen=True)
class Again:
    """A run for comparison.

    - `name`: description: ``bdf at rtol 1e-07``.
    - `solution`: None if there is no result.
    - `obstacle`: why it stopped early, or an empty string.
    - `remark`: remark of the solver on its steps, or an empty string.
    - `blind`: event that its steps missed but the first run found, or an empty string.
    - `at`: positions of the first run's times among its own.
    """

    name: str
    solution: Solution | None
    obstacle: str
    at: np.ndarray
    remark: str = ""
    blind: str = ""

    def reported(self, channel: str) -> np.ndarray:
        """Return a channel at the times of the first run that were reached."""
        assert self.solution is not None
        return self.solution[channel][self.at]

    @property
    def usable(self) -> bool:
        """True if results can be compared: those of explicit steps at their stability limit are noisy."""
        return self.solution is not None and not self.remark and not self.blind

    @property
    def whole(self) -> bool:
        """True if it is usable and reached the end."""
        return self.usable and not self.obstacle

    @property
    def channels(self) -> dict[str, np.ndarray]:
        """All channels at the times of the first run that were reached."""
        return {name: self.reported(name) for name in self.solution or ()}


Found = TypeVar("Found", Trajectory, Solution)


def uninterrupted(found: Found, deadline: Deadline | None = None) -> Found:
    """Return what was computed; raise KeyboardInterrupt if the user interrupted it, not its deadline."""
    if found.outcome is Outcome.INTERRUPTED and not (deadline and deadline.passed):
        raise KeyboardInterrupt
    return found


def solve_again(
    job: Job, name: str, changes: dict[str, object], times: np.ndarray, at: np.ndarray, allowed: float
) -> Again:
    """Solve with changed settings.

    `name`: for messages. `changes`: fields of the settings. `times`: output times, s, the start first. `at`: positions
    of the first run's times among them. `allowed`: allowed evaluations of the job's equations, which do not depend on
    the load of the machine.
    """
    if allowed <= 0:
        return Again(name, None, "not started: the limit of evaluations is reached", at[:0])
    other = job.varied(changes, times)
    deadline = Deadline(other.grid.start, other.grid.end, allowed, job.evaluations)
    try:
        solution = uninterrupted(solved(other, deadline), deadline)
    except StiffmbsError as error:
        return Again(name, None, str(error), at[:0])
    obstacle = "" if solution.outcome is Outcome.DONE else solution.message
    if solution.outcome is Outcome.INTERRUPTED:
        obstacle = f"aborted at t = {solution.time[-1]:.4g} s: it needs more than {allowed:.2g} evaluations"
    remark = solution.message.partition(f"{solution.outcome.value}; ")[2]
    return Again(name, solution, obstacle, at[at < len(solution.time)], remark)


def levels_of(rtol: float) -> tuple[int, ...]:
    """Return the levels of tighter tolerances, in powers of ten: a hundredth and a tenth if rounding permits."""
    return tuple(
        level
        for level, most in ((2, 10 * VERIFICATION.clearly_tighter), (1, 0.0))
        if rtol > most * VERIFICATION.tightest_rtol
    )


def tolerances(settings: RunSettings, level: int) -> dict[str, object]:
    """Return tolerances tighter by powers of ten, down to the tightest; looser ones if that is hardly tighter."""
    rtol = max(settings.rtol / 10**level, VERIFICATION.tightest_rtol)
    if settings.rtol < VERIFICATION.clearly_tighter * rtol:
        rtol = 10 * settings.rtol
    return {"rtol": rtol, **({"atol": settings.atol * rtol / settings.rtol} if settings.atol else {})}


def shorter_step(first: Solution) -> float:
    """Return a longest step, s, that multiplies the number of steps of a run."""
    steps, whole = np.diff(first.step_times), float(first.time[-1] - first.time[0])
    if not len(steps):
        return whole / VERIFICATION.least_steps
    wanted = max(VERIFICATION.more_steps * len(steps), VERIFICATION.least_steps)
    few, many = whole / (8 * wanted), whole
    for _ in range(60):  # bisection of the number of steps, which decreases with their length
        middle = np.sqrt(few * many)
        few, many = (middle, many) if np.sum(np.ceil(steps / middle)) > wanted else (few, middle)
    return float(f"{many:.2g}")


def other_integrators(first: Solution, settings: RunSettings) -> tuple[dict[str, object], ...]:
    """Return the settings of integrators whose errors are independent of those of a run, the preferred one first.

    After implicit steps, these are explicit ones, and for scenes that are too stiff for them the other implicit formula.
    """
    names = str(first.solver["name"]).split(", ")
    implicit = all(traits_of(changed(settings, {"solver": name})).implicit for name in names)
    if not implicit:
        return (BDF,)
    return EXPLICIT, (BDF if RADAU["solver"] in names else RADAU)
