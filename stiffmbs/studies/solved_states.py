"""Solution from the states at some instants."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..analyses.job import Job
from ..elements.requests.order import units
from ..model.scene import Scene
from ..notes import Note
from ..reading.units.display import SI_UNITS
from ..results.channels import channels_of
from ..results.energy_balance import energy_balance
from ..results.provenance import provenance_of
from ..results.solution import Solution
from ..solve.stiff_rows import States, with_stiff_forces
from ..solve.trajectory import History, Outcome


def solution_of(
    job: Job, t: np.ndarray, states: States, lengths: np.ndarray, project: bool, outcome: Outcome, message: str,
    notes: Sequence[Note] = (),
) -> Solution:  # fmt: skip
    """Return the solution at the given instants, from the start on.

    `states`: positions and velocities, a row for each instant. `lengths`: lengths of implicit steps, s. `project`: projects
    the states onto the constraints.
    """
    system = job.dynamics.system
    with job.dynamics.state.unchanged():
        rows = job.dynamics.report(t, *states, project=project)
        rows = with_stiff_forces(job.dynamics, states, rows, lengths, job.settings.rtol)
    channels = channels_of(job.data, system, rows)
    return Solution(
        name=job.data.name, time=job.shown(rows.t), channels=channels, outcome=outcome, message=message, notes=tuple(notes),
        solver={"name": job.settings.solver}, history=History(np.empty(0), np.empty(0, dtype=int)), not_unique=job.redundancy.not_unique,
        balance=energy_balance(system, rows),
        requested=units(job.data.outputs()), figure=job.data.figure if isinstance(job.data, Scene) else None,
        display=job.data.display if isinstance(job.data, Scene) else SI_UNITS,
        provenance=provenance_of(job.data, job.settings, state=job.start_from),
    )  # fmt: skip
