"""Runs whose steps passed over something are taken again, with a start at each instant that shows it.

The step that ends there sees the force, so that its error estimate makes it as short as it has to be.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..diagnostics.overlooked import Overlooked, overlooked, together
from ..diagnostics.within_long_steps import overlooked_in_long_steps
from ..solve.dynamics import OutputRows
from ..solve.trajectory import Outcome, Trajectory

if TYPE_CHECKING:
    from .run import Job

ROUNDS, STARTS = 3, 1000
"""How often a run is taken again, and with how many starts at the most."""
AGAIN = "the run was taken again with a start there; what neither output instants nor long steps show, max_step or more output points do"
LEFT = "the results may be wrong from there on; set max_step to far less than that"


@dataclass(frozen=True)
class Computed:
    """A trajectory, what is reported of it, and notes on instants that are left out."""

    trajectory: Trajectory
    rows: OutputRows
    left_out: list[str]


def seen_through(job: Job, compute: Callable[[Job], Computed]) -> tuple[Computed, list[str]]:
    """Compute a job until no instant looked at contradicts its steps; what there is to say of that.

    Parameters
    ----------
    job : Job
    compute : callable
        Integrates a job and reports it.
    """
    found = compute(job)
    seen = left = _overlooked(job, found)
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
        return found, [f"{left.sentence()}; {LEFT}"]
    return found, [f"{seen.sentence()}; {AGAIN}"] if seen else []


def _overlooked(job: Job, computed: Computed) -> Overlooked | None:
    """What output instants, or instants within long steps, show."""
    system, trajectory = job.dynamics.system, computed.trajectory
    if not system.has_laws:
        return None
    long_steps = () if trajectory.outcome is Outcome.INTERRUPTED else trajectory.long_steps
    found = [
        overlooked(system, computed.rows, trajectory, job.settings),
        *(overlooked_in_long_steps(steps, job.settings, float(trajectory.t[-1])) for steps in long_steps),
    ]
    return together([each for each in found if each is not None])
