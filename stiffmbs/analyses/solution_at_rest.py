"""Solutions of equilibria, one instant each."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..describe.requests.order import units
from ..errors import SolverError
from ..results.channels import channels_of, turns_of
from ..results.energy_balance import energy_balance
from ..results.solution import Solution
from ..solve.algebraic_states import failure
from ..solve.trajectory import History, Outcome
from .job import Job


def solution_at_rest(
    job: Job, t: np.ndarray, q: np.ndarray, u: np.ndarray, message: str, notes: tuple[str, ...], solver: dict[str, Any]
) -> Solution:
    """Return the channels of equilibria.

    Parameters
    ----------
    job : Job
    t, q, u : ndarrays, shapes (n,), (n, n_q), (n, n_u)
        Instants, s, with the poses and velocities at them.
    message : str
    notes : tuple of str
    solver : dict
        Statistics of the search.

    Raises
    ------
    SolverError
        If an equilibrium has no reactions.
    """
    system = job.dynamics.system
    rows = job.dynamics.report(t, q, u, project=False)
    if len(rows.t) < len(t):
        raise SolverError(
            f"no reactions were found in the equilibrium at t = {t[len(rows.t)]:g} s: {failure(job.dynamics, rows.status, t[len(rows.t)])}"
        )
    channels = channels_of(job.data, system, rows)
    return Solution(
        name=job.data.name, time=rows.t, channels=channels, outcome=Outcome.DONE, message=message, notes=notes,
        solver=solver, history=History(np.empty(0), np.empty(0, dtype=int)),
        balance=energy_balance(system, rows, np.empty(0)), not_unique=job.redundancy.not_unique,
        requested=units(job.data.outputs()), turns=turns_of(system, rows.q),
    )  # fmt: skip
