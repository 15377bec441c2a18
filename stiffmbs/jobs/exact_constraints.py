"""Runs whose relaxed constraints let velocities creep beyond the tolerance are taken again with exact ones.

SI2 holds J u + C_t = E_lam lam, with an E_lam so small that forces of usual size change nothing.  Where equations are nearly
dependent, or forces are huge for the masses, lam is not: velocities creep, and energy is lost.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from ..diagnostics.creep import Creep, creep_of
from ..solve import traits_of
from ..solve.trajectory import Outcome
from .taken_again import Computed

if TYPE_CHECKING:
    from .run import Job

RELAXED, EXACT = "SI2", "SI2_exact"
CREPT = 30.0
"""Tolerances of a velocity, as a mean over the run, up to which creep reaches no result: errors of runs with more begin to show
it.  Examples and benchmarks have 0 to 5."""


def on_exact_constraints(job: Job, compute: Callable[[Job], Computed]) -> Computed:
    """Compute a job, and once more by SI2_exact where its constraints crept; of that the result has a note.

    Parameters
    ----------
    job : Job
    compute : callable
        Integrates a job and reports it.
    """
    found = compute(job)
    if not _relaxed(job) or not len(found.rows.t):
        return found
    creep = creep_of(job.dynamics.system, found.rows, found.trajectory, job.settings)
    if not creep.mean > CREPT:
        return found
    if found.trajectory.outcome is Outcome.INTERRUPTED:
        return _noted(found, f"{_sentence(creep)}; the results may be wrong by that")
    again = compute(replace(job, settings=job.settings.model_copy(update={"formulation": EXACT})))
    if len(again.rows.t) < len(found.rows.t):
        return _noted(found, f"{_sentence(creep)}; the results may be wrong by that, and formulation {EXACT} does not come as far: {again.trajectory.message}")
    return _noted(again, f"{_sentence(creep)}; the run was taken again by formulation {EXACT}")


def _relaxed(job: Job) -> bool:
    """Whether a run follows relaxed constraints."""
    relaxed = job.settings.formulation == RELAXED and "formulation" in traits_of(job.settings).reads
    return relaxed and job.on_constraints and job.dynamics.system.n_c > 0


def _sentence(creep: Creep) -> str:
    return (
        f"under the forces in '{creep.joint}' the relaxed constraints of formulation {RELAXED} let {creep.velocity} creep "
        f"by {creep.mean:.2g} tolerances"
    )


def _noted(computed: Computed, note: str) -> Computed:
    return replace(computed, left_out=[*computed.left_out, note])
