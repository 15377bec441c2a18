"""Trust in one run: the scene is solved again, tighter and in another way, and what differs becomes error bars and doubts.

1. With the same solver at a hundredth of the tolerance (half the step of fixed schemes), reported at the first run's own
   steps besides its output instants, so that peaks between these are seen.
2. With the other integrator, at a hundredth of the tolerance: bdf's errors and those of explicit steps have nothing in common.
3. With the same solver at a tolerance between (a quarter of the step), where the other integrator says nothing, or the
   first two look suspicious: then the order of convergence tells.

A tenth of the tolerance is not enough for the first: bdf's error then shrinks by 2 to 10 times, and one peak in twenty has
nearly the same error in both runs.

All within a few times the first run's time; what was not done is said.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from ..describe.model_builder import ModelBuilder
from ..describe.model_data import ModelData
from ..describe.settings import RunSettings
from ..solve.explicit import ADAPTIVE
from ..solve.trajectory import Watch
from .between import Between, looked_between, more_instants
from .doubts import Comparison, doubts
from .error_bars import ErrorBar, error_bar
from .run import Job, prepare, solved
from .scales import scales
from .solution import Solution
from .solve_again import Again, solve_again

MOST_EFFORT, PATIENCE = 3.0, 1.0
"""Time for all that is solved again, in times of the first run; s that nobody minds waiting all the same."""
TIGHTEST = 1e-13
"""Relative tolerance below which steps fail by rounding."""
APART = 2.0
"""Times tighter that a tolerance must be at the least to tell anything beside another."""
OTHER_OF_FIXED = 1e-10
"""Relative tolerance of the other solver where the first has fixed steps."""
ROUNDING = 1e-13
"""Part of a channel's scale that rounding takes."""


def verify(
    model: ModelBuilder | ModelData, settings: RunSettings | None = None, watch: Watch | None = None, **changes: Any
) -> Solution:
    """Solve a model, and solve it again to see what its results are worth; parameters and errors as for `run`.

    Returns
    -------
    Solution
        The same that `run` returns, with `errors` (the bars of each channel), `verification` (what was compared) and
        further `notes` where the results are in doubt.
    """
    begun = time.perf_counter()
    job = prepare(model, settings, **changes)
    first = solved(job, watch)
    if len(first.time) < 2:
        return replace(first, verification=("not verified: nothing was solved",))
    return verified(job, first, max(PATIENCE, MOST_EFFORT * (time.perf_counter() - begun)))


def verified(job: Job, first: Solution, allowed: float) -> Solution:
    """What `verify` returns, for a job that was solved already.

    Parameters
    ----------
    job : Job
    first : Solution
        Of the job, at two instants at least.
    allowed : float
        Time for all that is solved again, s.
    """
    return _Verification(job, first, allowed).result()


class _Verification:
    """The runs that one run is compared with."""

    def __init__(self, job: Job, first: Solution, allowed: float) -> None:
        self._job, self._first = job, first
        self._begun, self._allowed = time.perf_counter(), allowed
        self._sizes = scales(first.channels, job.mechanics.system.size)
        self._exact = job.settings.solver == "kinematic"
        self._between: Between | None = None
        self._tighter: dict[int, Again] = {}
        self._other: Again | None = None
        self._skipped: list[str] = []

    def result(self) -> Solution:
        """The first run with what the others say of it."""
        try:
            self._solve()
        except KeyboardInterrupt:
            self._skipped.append("verification interrupted by the user")
        comparison = self._comparison()
        return replace(
            self._first, errors=comparison.bars, verification=tuple(self._told()),
            notes=(*self._first.notes, *doubts(comparison)),
        )  # fmt: skip

    def _solve(self) -> None:
        self._look_between()
        if self._exact:
            return
        self._ask_the_other()
        if self._other is None or self._other.obstacle or not _judges(self._other) or self._comparison().suspicious:
            self._tighten()

    def _look_between(self) -> None:
        """The first tighter run, also at instants between those of the output; the next one where it does not end."""
        start, end = float(self._first.time[0]), float(self._first.time[-1])
        times = more_instants(self._first, self._job.mechanics.input_features(start, end))
        at = np.searchsorted(times, self._first.time)
        for level in self._levels():
            run = self._run(level, times, at)
            self._between = looked_between(self._job, run, self._sizes, max(self._left(), PATIENCE))
            if not run.obstacle:
                return

    def _tighten(self) -> None:
        """The next of the tighter runs."""
        reported = self._first.time
        for level in self._levels():
            if level not in self._tighter:
                self._run(level, reported, np.arange(len(reported)))
                return

    def _run(self, level: int, times: np.ndarray, at: np.ndarray) -> Again:
        name, changes = self._tighter_settings(level)
        run = solve_again(self._job, name, changes, times, at, self._left())
        if not self._exact:
            self._tighter[level] = run
        return run

    def _levels(self) -> tuple[int, ...]:
        """How much tighter the runs are, in tenths of the tolerance or halves of the step, in the order of their use."""
        settings = self._job.settings
        if self._exact:
            return (1,)
        return (1, 2) if _fixed(settings) else _levels_of(settings.rtol)

    def _tighter_settings(self, level: int) -> tuple[str, dict[str, Any]]:
        settings = self._job.settings
        if self._exact:
            return "kinematic between the output instants", {}
        if _fixed(settings):
            step = settings.step / 2**level
            return f"{settings.scheme} with steps of {step:.3g} s", {"step": step}
        changes = _tolerances(settings, level)
        return f"{_name(settings.solver, settings.scheme)} at rtol {changes['rtol']:.3g}", changes

    def _ask_the_other(self) -> None:
        settings, reported = self._job.settings, self._first.time
        solver = "projected" if self._first.solver["name"] == "bdf" else "bdf"
        how = {"solver": solver, "scheme": "dop853", "formulation": "SI2", "projection": True}
        changes = {**how, **({"rtol": OTHER_OF_FIXED} if _fixed(settings) else _tolerances(settings, 2))}
        name = f"{_name(solver, 'dop853')} at rtol {changes['rtol']:.3g}"
        self._other = solve_again(self._job, name, changes, reported, np.arange(len(reported)), self._left())

    def _left(self) -> float:
        return self._allowed - (time.perf_counter() - self._begun)

    def _comparison(self) -> Comparison:
        runs = [self._tighter[level] for level in sorted(self._tighter)]
        tighter = tuple(run for run in runs if run.solution is not None)
        other = self._other if _judges(self._other) else None
        bars = {
            name: self._bar(name, [*tighter, *([other] if other else [])])
            for name in self._first
            if name not in self._first.not_unique and not name.startswith("constraint.")
        }
        return Comparison(self._job, self._first, tighter, other, self._between, bars, self._sizes)

    def _bar(self, name: str, runs: list[Again]) -> ErrorBar:
        fine = self._between.fine(name) if self._between else None
        return error_bar(self._first[name], [run.reported(name) for run in runs], fine, ROUNDING * self._sizes[name])

    def _told(self) -> list[str]:
        """What was compared with, and what could not be."""
        runs = [run for run in (*self._tighter.values(), self._other) if run is not None]
        done = [run.name for run in runs if not run.obstacle and (run is not self._other or _judges(run))]
        told = [f"solved again with {' and '.join(done)}"] if done else []
        if self._exact:
            told = ["kinematic: positions follow from the drives alone, exact but for rounding; bars are of sampling"]
        told += [f"{run.name}: {run.obstacle}" for run in runs if run.obstacle]
        if self._other is not None and self._other.remark:
            told.append(f"{self._other.name}, not counted: {self._other.remark}")
        if self._between is None:
            told.append("nothing is known between the output instants")
        elif self._between.singular:
            told.append(
                f"at t = {self._between.singular[0]:.6g} s the pose is singular: accelerations and reactions have no value "
                "there, and their peaks are those of other instants"
            )
        return [*told, *self._skipped]


def _judges(other: Again | None) -> bool:
    """Whether a run of the other solver says something: explicit steps at their limit of stability are noisy."""
    return other is not None and other.solution is not None and not other.remark


def _levels_of(rtol: float) -> tuple[int, ...]:
    """A hundredth and a tenth of a tolerance, as far as rounding leaves both."""
    return tuple(level for level, most in ((2, 10 * APART), (1, 0.0)) if rtol > most * TIGHTEST)


def _tolerances(settings: RunSettings, level: int) -> dict[str, Any]:
    """Tighter by so many powers of ten, down to the tightest; looser where that is hardly tighter: then that run's error shows."""
    rtol = max(settings.rtol / 10**level, TIGHTEST)
    if settings.rtol < APART * rtol:
        rtol = 10 * settings.rtol
    return {"rtol": rtol, **({"atol": settings.atol * rtol / settings.rtol} if settings.atol else {})}


def _fixed(settings: RunSettings) -> bool:
    return settings.solver == "projected" and settings.scheme not in ADAPTIVE


def _name(solver: str, scheme: str) -> str:
    return scheme if solver == "projected" else solver
