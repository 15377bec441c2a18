"""A study of error bars: how many peaks of verified runs lie within their bars, and how far the worst lies outside.

Run it by ``python -m tests.bench.error_bars [PROBLEM...]``; it prints the table of ``docs/verify.md``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.analyses.run import solved
from stiffmbs.model.model_builder import ModelBuilder
from stiffmbs.model.model_data import ModelData
from stiffmbs.results.error_bars import ErrorBar
from stiffmbs.results.scales import scales
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Grid
from stiffmbs.verification.missed_events import more_instants
from stiffmbs.verification.verify import verified

from .error_control import bushing_in_place, scene

SOLVERS = ("bdf", "projected")
RTOLS = (1e-4, 1e-6, 1e-8)
POINTS, FINER = 401, 8
"""Output instants of a run; into how many parts the time between two is cut to see the true peaks."""
REFERENCES = (1e-12, 1e-13)
"""Relative tolerances: of what tells how well the truth is known, and of what a run is held against."""
KNOWN = 10.0
"""An error counts where it is so many times as large as that of the reference."""
LEAST_ERROR = 1e-11
"""Part of a channel's scale below which an error is none."""
PATIENCE = 1e7
"""Evaluations of the equations for all runs that one is compared with."""


@dataclass(frozen=True)
class Problem:
    """A model, the duration over which errors stay comparable, s, and the solver that is to be trusted with it."""

    model: Callable[[], ModelBuilder | ModelData]
    duration: float
    trusted: str = "projected"


@dataclass(frozen=True)
class Found:
    """Widths of bars relative to the true errors, of as many peaks (or channels) as have an error.

    Attributes
    ----------
    reported : ndarray
        Peaks of what is reported: against the truth at the same instants, the bar without what lies between these.
    peaks : ndarray
        Peaks against those of the truth, wherever they are.
    over_time : ndarray
        The largest error of a channel at an output instant.
    """

    reported: np.ndarray = field(default_factory=lambda: np.empty(0))
    peaks: np.ndarray = field(default_factory=lambda: np.empty(0))
    over_time: np.ndarray = field(default_factory=lambda: np.empty(0))


PROBLEMS = {
    "cart_pendulum": Problem(scene("cart_pendulum"), 10.0),
    "bar_pendulum": Problem(scene("bar_pendulum"), 3.0),
    "andrews": Problem(scene("andrews"), 0.03),
    "half_car": Problem(scene("half_car"), 2.0),
    "half_car_1e7": Problem(scene("half_car", ("k_b", "1e7")), 1.0, "bdf"),
    "bushing_1e6": Problem(partial(bushing_in_place, 1e6), 1.0),
    "elastic_bearing": Problem(scene("elastic_bearing"), 0.04),
    "chain": Problem(scene("chain"), 0.8),
    "bouncing_ball": Problem(scene("bouncing_ball"), 0.8),
    "stick_slip": Problem(scene("stick_slip"), 1.0),
    "heavy_top": Problem(scene("heavy_top"), 1.0),
    "governor": Problem(scene("governor"), 2.0),
    "bricard": Problem(scene("bricard"), 5.0),
    "spatial_slider_crank": Problem(scene("spatial_slider_crank"), 2.0),
    "spatial_chain": Problem(scene("spatial_chain"), 0.8),
    "dzhanibekov": Problem(scene("dzhanibekov"), 5.0),
    "door": Problem(scene("door"), 5.0),
    "rolling_disc": Problem(scene("rolling_disc"), 5.0),
}


def measured(problem: Problem, rtols: Iterable[float] = RTOLS) -> Iterator[tuple[str, float, Found]]:
    """The bars of one problem beside its true errors, by solver and tolerance."""
    model = problem.model()

    def job(solver: str, rtol: float, points: int) -> Job:
        return prepare(model, duration=problem.duration, solver=solver, rtol=rtol, points=points)

    fine = FINER * (POINTS - 1) + 1
    less_true, truth = (at_more_instants(job(problem.trusted, rtol, fine)) for rtol in REFERENCES)
    for solver in SOLVERS:
        for rtol in rtols:
            asked = job(solver, rtol, POINTS)
            found = verified(asked, solved(asked), PATIENCE)
            yield (
                solver,
                rtol,
                compared(found, truth, less_true, scales(truth, asked.dynamics.system.size, truth.requested)),
            )


def at_more_instants(job: Job) -> Solution:
    """A job solved, and solved again at its own steps and between these besides."""
    times = more_instants(solved(job), job.dynamics.input_features(job.grid.start, job.grid.end))
    return solved(replace(job, grid=Grid(job.grid.start, job.grid.end, times)))


def compared(found: Solution, truth: Solution, less_true: Solution, sizes: Mapping[str, float]) -> Found:
    """A verified run beside the truth at finer instants, and beside what tells how well that is known."""
    reported, peaks, over_time = [], [], []
    at, beside_at = (np.searchsorted(run.time, found.time - 1e-9 * found.time[-1]) for run in (truth, less_true))
    for name, bar in found.errors.items():
        best, beside = truth[name][at], less_true[name][beside_at]
        least = LEAST_ERROR * sizes[name]
        over_time.append((bar.over_time, _apart(found[name], best), _apart(best, beside) + least))
        for sign, half, between in _ends(bar):
            value, top, top_beside = (np.max(sign * values) for values in (found[name], best, beside))
            known = abs(top - top_beside) + least
            reported.append((half - between, abs(value - top), known))
            peak, parabola = _peak(truth.time, sign * truth[name])
            peaks.append((half, abs(value - peak), known + parabola / KNOWN))
    return Found(_parts(reported), _parts(peaks), _parts(over_time))


def _ends(bar: ErrorBar) -> tuple[tuple[float, float, float], ...]:
    """Both ends of a channel: a sign that makes it the greatest, the half width, and what of that lies between instants."""
    return (1.0, bar.greatest, bar.sampled_greatest), (-1.0, bar.least, bar.sampled_least)


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.max(np.abs(one - other)))


def _peak(times: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """The greatest value, at the top of the parabola through three, and how far that is above them."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(values[k]), 0.0
    bend, slope, _ = np.polyfit(times[k - 1 : k + 2] - times[k], values[k - 1 : k + 2] - values[k], 2)
    beyond = -(slope**2) / (4 * bend) if bend else 0.0
    return float(values[k] + beyond), float(beyond)


def _parts(rows: Iterable[tuple[float, float, float]]) -> np.ndarray:
    """Half widths relative to the errors, where these are known."""
    half, error, known = np.array(list(rows)).T
    counted = error > KNOWN * known
    return half[counted] / error[counted]


def cell(parts: np.ndarray) -> str:
    """Share of peaks within their bars, the worst error in bars, and a usual bar in errors."""
    if not len(parts):
        return "exact"
    worst = 1.0 / max(float(np.min(parts)), np.finfo(float).tiny)
    share = np.floor(1000 * np.mean(parts >= 1.0)) / 10  # 100 % is said of all alone
    return f"{share:.1f} % / {worst:.1f} / {np.median(parts):.1f}"


def main(names: list[str]) -> None:
    """Print the table, in the form of a page."""
    print(f"| problem | solver | {' | '.join(f'rtol {rtol:g}' for rtol in RTOLS)} |")
    print("|---" * (2 + len(RTOLS)) + "|")
    all_found: dict[tuple[str, float], list[Found]] = {(solver, rtol): [] for solver in SOLVERS for rtol in RTOLS}
    for name in names or PROBLEMS:
        own = {(solver, rtol): found for solver, rtol, found in measured(PROBLEMS[name])}
        for key, found in own.items():
            all_found[key].append(found)
        for solver in SOLVERS:
            print(
                f"| {name} | {solver} | {' | '.join(cell(own[solver, rtol].reported) for rtol in RTOLS)} |", flush=True
            )
    for title, of in (("all", "reported"), ("all, true peaks", "peaks"), ("all, over time", "over_time")):
        for solver in SOLVERS:
            joined = (np.concatenate([getattr(found, of) for found in all_found[solver, rtol]]) for rtol in RTOLS)
            print(f"| **{title}** | {solver} | {' | '.join(map(cell, joined))} |")


if __name__ == "__main__":
    main(sys.argv[1:])
