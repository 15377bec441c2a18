"""Reruns of jobs whose results contradict their equations.

After missed events a job is rerun with a restart at each instant that shows one.  The step that ends there includes the
force, and its error estimate shortens it as required.  A Python function has no event functions, and its narrow features
may be met at other times in the rerun: all steps of this one are shorter than the shortest feature found.

If relaxed constraints drift beyond the tolerance, a job is rerun with exact ones.  SI2 holds J u + C_t = E_lam lam,
with E_lam so small that forces of usual size have no effect.  If equations are nearly dependent, or forces are huge for
the masses, lam is not of usual size: velocities drift, and energy is lost.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..dynamics.dynamics import OutputRows
from ..run_checks.overlooked import Overlooked, overlooked, overlooked_in_long_steps, together
from ..solve.error_control.relaxation import Drift, drift_of, drifts
from ..solve.settings import changed, traits_of
from ..solve.trajectory import Outcome, Trajectory

if TYPE_CHECKING:
    from ..compile.system import System
    from ..model.settings import RunSettings
    from .job import Job

ROUNDS, STARTS = 3, 1000
"""Number of reruns, and of restarts in a rerun, at most."""
AGAIN = "the run was repeated with a restart there; set max_step, or request more output points, to resolve events between output times"
PART_OF_A_FEATURE = 0.5
"""Longest step of a rerun, relative to the shortest missed feature of a Python function."""
MOST_STEPS = 200_000
"""Most steps of such a rerun."""
LEFT = "the results may be wrong from there on; set max_step to a much smaller value"

RELAXED, EXACT = "SI2", "SI2_exact"
DRIFTED = 10.0
"""Mean velocity drift over the run, in tolerances, up to which a run is accepted."""
LESS = 0.5
"""Part of the drift that exact constraints may leave."""


@dataclass(frozen=True)
class Computed:
    """Trajectory and rows of a run, notes on omitted rows, the job that was computed, and notes on doubts."""

    trajectory: Trajectory
    rows: OutputRows
    left_out: list[str]
    job: Job
    doubts: tuple[str, ...] = ()


def rerun_after_missed_events(job: Job, compute: Callable[[Job], Computed]) -> tuple[Computed, list[str]]:
    """Compute a job until no checked instant contradicts its steps; return it with notes on missed events."""
    found = compute(job)
    seen = left = _overlooked(job, found)
    if seen and job.dynamics.system.has_functions and "max_step" in traits_of(job.settings).reads:
        return _with_shorter_steps(job, compute, found, seen)
    stops = np.empty(0)
    for _ in range(ROUNDS):
        if left is None or found.trajectory.outcome is Outcome.INTERRUPTED:
            break
        stops = np.union1d(stops, left.times)
        if len(stops) > STARTS:
            break
        again = compute(replace(job, grid=replace(job.grid, stops=stops)))
        if again.trajectory.outcome is Outcome.INTERRUPTED:
            break
        found, left = again, _overlooked(job, again)
    if left is not None:
        note = f"{left.sentence()}; {LEFT}"
        return replace(found, doubts=(*found.doubts, note)), [note]
    return found, [f"{seen.sentence()}; {AGAIN}"] if seen else []


def _with_shorter_steps(
    job: Job, compute: Callable[[Job], Computed], found: Computed, seen: Overlooked
) -> tuple[Computed, list[str]]:
    """Repeat a job until its steps resolve the features of Python functions; return it with a note."""
    left: Overlooked | None = seen
    longest = math.inf
    for _ in range(ROUNDS):
        if left is None or found.trajectory.outcome is Outcome.INTERRUPTED:
            break
        longest = min(longest, PART_OF_A_FEATURE * left.shortest)
        if job.grid.end - job.grid.start > MOST_STEPS * longest:
            break
        again = compute(replace(job, settings=changed(job.settings, {"max_step": longest})))
        if again.trajectory.outcome is Outcome.INTERRUPTED:
            break
        found, left = again, _overlooked(job, again)
    if left is not None:
        note = f"{seen.sentence()}; {LEFT}"
        return replace(found, doubts=(*found.doubts, note)), [note]
    return found, [f"{seen.sentence()}; the run was repeated with max_step {longest:.2g} s"]


def _overlooked(job: Job, computed: Computed) -> Overlooked | None:
    """Return the missed events that output instants, or instants within long steps, show."""
    system, trajectory = job.dynamics.system, computed.trajectory
    if not system.has_laws:
        return None
    long_steps = () if trajectory.outcome is Outcome.INTERRUPTED else trajectory.long_steps
    found = [
        overlooked(job.dynamics, computed.rows, trajectory, job.settings),
        *(overlooked_in_long_steps(steps, job.settings, float(trajectory.t[-1])) for steps in long_steps),
    ]
    return together([each for each in found if each is not None])


def on_exact_constraints(job: Job, compute: Callable[[Job], Computed]) -> Computed:
    """Compute a job, and rerun it with SI2_exact if its constraints drift; the result has a note on that."""
    found = compute(job)
    compared = _compared(job, found)
    if not relaxed(job) or not len(found.rows.t) or not drifts(*compared, DRIFTED):
        return found
    drift = _drift(job, found)
    stopped = found.trajectory.outcome is Outcome.STOPPED
    if not (drift.mean > DRIFTED or (stopped and drift.at_end > DRIFTED)):
        return found
    if found.trajectory.outcome is Outcome.INTERRUPTED:
        return _doubted(found, f"{drift.sentence()}; the results may be wrong by this amount")
    again = compute(exactly(job))
    if len(again.rows.t) >= len(found.rows.t):
        # the rest is no drift, but jumps of velocities without a known breakpoint
        if drift.mean > DRIFTED and _drift(job, again).mean > LESS * drift.mean:
            return found
        return _noted(again, f"{drift.sentence()}; the run was repeated with formulation {EXACT}")
    if stopped:
        return found
    return _doubted(
        found,
        f"{drift.sentence()}; the results may be wrong by this amount, and formulation {EXACT} stopped earlier: "
        f"{again.trajectory.message}",
    )


def _drift(job: Job, computed: Computed) -> Drift:
    breakpoints = job.dynamics.input_features(job.grid.start, job.grid.end).breakpoints
    return drift_of(*_compared(job, computed), breakpoints)


def _compared(job: Job, computed: Computed) -> tuple[System, OutputRows, Trajectory, RunSettings]:
    """Return the data from which drift is computed."""
    return job.dynamics.system, computed.rows, computed.trajectory, job.settings


def relaxed(job: Job) -> bool:
    """Return True if a run has relaxed constraints."""
    chosen = job.settings.formulation == RELAXED and "formulation" in traits_of(job.settings).reads
    return chosen and job.on_constraints and job.dynamics.system.n_c > 0


def exactly(job: Job) -> Job:
    """Return the job with exact constraints."""
    return replace(job, settings=changed(job.settings, {"formulation": EXACT}))


def _noted(computed: Computed, note: str) -> Computed:
    return replace(computed, left_out=[*computed.left_out, note])


def _doubted(computed: Computed, note: str) -> Computed:
    """Add a note that questions the results."""
    return replace(_noted(computed, note), doubts=(*computed.doubts, note))
