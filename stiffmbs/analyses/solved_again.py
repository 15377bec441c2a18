"""Solution of the interval between two output times again, from the state at the first of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import SolverError
from ..solve.events.restart import restarted
from ..solve.missing_rows import reported
from ..solve.trajectory import Grid, Outcome
from .job import Job, up_to_a_fault


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
