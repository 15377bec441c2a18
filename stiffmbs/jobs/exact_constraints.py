"""Runs whose relaxed constraints let velocities creep beyond the tolerance are taken again with exact ones.

SI2 holds J u + C_t = E_lam lam, with an E_lam so small that forces of usual size change nothing.  Where equations are nearly
dependent, or forces are huge for the masses, lam is not: velocities creep, and energy is lost.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from ..diagnostics.creep import creep_of
from ..solve import traits_of
from ..solve.settings import changed
from ..solve.trajectory import Outcome
from .taken_again import Computed

if TYPE_CHECKING:
    from .run import Job

RELAXED, EXACT = "SI2", "SI2_exact"
CREPT = 10.0
"""Tolerances of a velocity, as a mean over the run, up to which creep is left alone: with 25 a pendulum's error is that many
tolerances too.  The examples have 0 to 5."""


def on_exact_constraints(job: Job, compute: Callable[[Job], Computed]) -> Computed:
    """Compute a job, and once more by SI2_exact where its constraints crept; of that the result has a note.

    Parameters
    ----------
    job : Job
    compute : callable
        Integrates a job and reports it.
    """
    found = compute(job)
    if not relaxed(job) or not len(found.rows.t):
        return found
    creep = creep_of(job.dynamics.system, found.rows, found.trajectory, job.settings)
    stopped = found.trajectory.outcome is Outcome.STOPPED
    if not (creep.mean > CREPT or (stopped and creep.at_end > CREPT)):
        return found
    if found.trajectory.outcome is Outcome.INTERRUPTED:
        return _noted(found, f"{creep.sentence()}; the results may be wrong by that")
    again = compute(exactly(job))
    if len(again.rows.t) >= len(found.rows.t):
        return _noted(again, f"{creep.sentence()}; the run was taken again by formulation {EXACT}")
    return _noted(
        found,
        f"{creep.sentence()}; the results may be wrong by that, and formulation {EXACT} does not come as far: "
        f"{again.trajectory.message}",
    )


def relaxed(job: Job) -> bool:
    """Whether a run follows relaxed constraints."""
    chosen = job.settings.formulation == RELAXED and "formulation" in traits_of(job.settings).reads
    return chosen and job.on_constraints and job.dynamics.system.n_c > 0


def exactly(job: Job) -> Job:
    """The job with exact constraints."""
    return replace(job, settings=changed(job.settings, {"formulation": EXACT}))


def _noted(computed: Computed, note: str) -> Computed:
    return replace(computed, left_out=[*computed.left_out, note])
