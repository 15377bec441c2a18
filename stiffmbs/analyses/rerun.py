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
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..dynamics.dynamics import OutputRows
from ..errors import SolverError
from ..notes import Note, NoteKind, Severity
from ..run_checks.overlooked import MISSED, Overlooked, overlooked, overlooked_in_whole_steps, together, unchecked_from
from ..solve.error_control.relaxation import DRIFT, Drift, drift_of, drifts
from ..solve.events.restart import restarted
from ..solve.missing_rows import reported
from ..solve.settings import traits_of
from ..solve.trajectory import Grid, Outcome, Trajectory
from .job import Job, up_to_a_fault

if TYPE_CHECKING:
    from ..compile.system import System
    from ..model.settings import RunSettings

ROUNDS, STARTS = 3, 1000
"""Number of reruns, and of restarts in a rerun, at most."""
PART_OF_A_FEATURE = 0.5
"""Longest step of a rerun, relative to the shortest missed feature of a Python function."""
MOST_STEPS = 200_000
"""Most steps of such a rerun."""

RELAXED, EXACT = "SI2", "SI2_exact"
DRIFTED = 10.0
"""Mean velocity drift over the run, in tolerances, up to which a run is accepted."""
LESS = 0.5
"""Part of the drift that exact constraints may leave."""

RESTARTED = NoteKind(
    "missed-event-restarted", MISSED + "; the run was repeated with a restart there",
    "set max_step, or request more output points, to resolve events between output times", Severity.REMARK,
)  # fmt: skip
SHORTENED = NoteKind(
    "missed-event-shorter-steps",
    MISSED + "; the run was repeated with max_step {max_step:.2g} s",
    severity=Severity.REMARK,
)
STILL_MISSED = NoteKind(
    "missed-event", MISSED + "; the results may be wrong from there on", "set max_step to a much smaller value",
    Severity.DOUBT,
)  # fmt: skip
UNCHECKED = NoteKind(
    "missed-event-unchecked",
    "Python functions: {count} steps were checked for features that they missed; those after t = {t:.6g} s were not",
    "set max_step to the duration of the shortest feature, or compare with a run of smaller steps", Severity.REMARK,
)  # fmt: skip
REPEATED = NoteKind(
    "constraint-drift-removed", f"{DRIFT}; the run was repeated with formulation {EXACT}", severity=Severity.REMARK
)
DRIFT_LEFT = NoteKind(
    "constraint-drift", DRIFT + "; the results may be wrong by this amount{reason}", severity=Severity.DOUBT
)


@dataclass(frozen=True)
class Computed:
    """Trajectory and rows of a run, the job that was computed, and notes on missed events, drift and omitted rows."""

    trajectory: Trajectory
    rows: OutputRows
    job: Job
    notes: tuple[Note, ...]


def rerun_after_missed_events(job: Job, compute: Callable[[Job], Computed]) -> Computed:
    """Compute a job until no checked instant contradicts its steps; return it with a note on missed events."""
    found, missed = _checked(job, compute(job)), list[Overlooked]()
    left = _overlooked(job, found)
    may_shorten = job.dynamics.system.has_functions and "max_step" in traits_of(job.settings).reads
    shortens = False
    while left is not None and len(missed) < ROUNDS and found.trajectory.outcome is not Outcome.INTERRUPTED:
        missed.append(left)
        shortens = may_shorten and _longest_step(missed) < math.inf  # found at output times alone, it has no duration
        other = _shortened(job, missed) if shortens else _restarted(job, missed)
        if other is None or (again := _checked(job, compute(other))).trajectory.outcome is Outcome.INTERRUPTED:
            break
        found, left = again, _overlooked(job, again)
    if left is not None:
        return _noted(found, left.note(STILL_MISSED))
    if not missed:
        return found
    return _noted(found, missed[0].note(SHORTENED if shortens else RESTARTED, _longest_step(missed)))


def _checked(job: Job, computed: Computed) -> Computed:
    """Return what was computed with a note on steps with Python functions that are not checked."""
    for steps in computed.trajectory.whole_steps:
        t = unchecked_from(steps, computed.trajectory, job.settings)
        if t < math.inf:
            return _noted(computed, UNCHECKED("", count=len(steps.begin), t=t))
    return computed


def _restarted(job: Job, missed: Sequence[Overlooked]) -> Job | None:
    """Return a job with restarts at the times of missed events; None if there are too many."""
    stops = np.unique(np.concatenate([each.times for each in missed]))
    return replace(job, grid=replace(job.grid, stops=stops)) if len(stops) <= STARTS else None


def _shortened(job: Job, missed: Sequence[Overlooked]) -> Job | None:
    """Return a job whose steps resolve the missed features of Python functions; None if there would be too many."""
    longest = _longest_step(missed)
    return job.varied({"max_step": longest}) if job.grid.end - job.grid.start <= MOST_STEPS * longest else None


def _longest_step(missed: Sequence[Overlooked]) -> float:
    return PART_OF_A_FEATURE * min(each.shortest for each in missed)


def _overlooked(job: Job, computed: Computed) -> Overlooked | None:
    """Return the missed events found at output times, and within steps with Python functions."""
    system, trajectory = job.dynamics.system, computed.trajectory
    if not system.has_laws:
        return None
    whole_steps = () if trajectory.outcome is Outcome.INTERRUPTED else trajectory.whole_steps
    found = [
        overlooked(job.dynamics, computed.rows, trajectory, job.settings, partial(_again, computed)),
        *(overlooked_in_whole_steps(steps, job.settings, float(trajectory.t[-1])) for steps in whole_steps),
    ]
    return together([each for each in found if each is not None])


def _again(computed: Computed, k: int) -> np.ndarray | None:
    """Return the velocities at the output row after row `k` from a solution that starts at row `k`, or None."""
    rows, job = computed.rows, computed.job.of_one_solver(computed.trajectory)
    return velocities_again(job, rows.t[k : k + 2], rows.q[k], rows.u[k])


def velocities_again(job: Job, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray | None:
    """Return the velocities at the second of two output times, s, from a solution that starts at the first one.

    `q`, `u` of shapes (n_q,), (n_u,): state at the first time. None if the solution does not reach the second time.
    """
    try:
        start = restarted(job.dynamics, t[0], q, u, project=False)
        subsystems = tuple(
            each._replace(start=restarted(each.dynamics, t[0], *each.part.reduced(q, u), project=False))
            for each in job.subsystems
        )
        grid = Grid(float(t[0]), float(t[1]), t)
        interval = replace(job, grid=grid, start=start, subsystems=subsystems, monitor=None)
        found = up_to_a_fault(job.dynamics.system, interval.integrate())
    except SolverError:
        return None
    rows, _ = reported(job.dynamics, found, job.on_constraints, job.settings.rtol)
    return rows.u[-1] if found.outcome is Outcome.DONE and len(rows.t) == len(t) else None


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
        return _noted(found, drift.note(DRIFT_LEFT))
    again = compute(exactly(job))
    if len(again.rows.t) >= len(found.rows.t):
        # the rest is no drift, but jumps of velocities without a known breakpoint
        if drift.mean > DRIFTED and _drift(job, again).mean > LESS * drift.mean:
            return found
        return _noted(again, drift.note(REPEATED))
    if stopped:
        return found
    return _noted(
        found, drift.note(DRIFT_LEFT, f", and formulation {EXACT} stopped earlier: {again.trajectory.message}")
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
    return job.varied({"formulation": EXACT})


def _noted(computed: Computed, note: Note) -> Computed:
    return replace(computed, notes=(*computed.notes, note))
