"""Solutions of single instants: equilibria, and instants of a natural mode."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.system import System
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import OutputRows
from ..elements.requests.order import units
from ..errors import SolverError
from ..model.model_data import ModelData
from ..results.channels import channels_of, turns_of
from ..results.energy_balance import energy_balance
from ..results.solution import Solution
from ..solve.trajectory import History, Outcome
from .job import Job


def solution_at_rest(
    job: Job, t: np.ndarray, q: np.ndarray, u: np.ndarray, message: str, notes: tuple[str, ...], solver: dict[str, Any]
) -> Solution:
    """Return the channels of equilibria with these instants, s, poses and velocities.

    Raise a SolverError if one has no reactions.
    """
    rows = job.dynamics.report(t, q, u, project=False)
    if len(rows.t) < len(t):
        first = t[len(rows.t)]
        raise SolverError(
            f"no reactions were found in the equilibrium at t = {first:g} s: {failure(job.dynamics, rows.status, first)}"
        )
    return solution_of_rows(
        job.data.name, job.data, job.dynamics.system, rows, job.redundancy.not_unique, message, notes, solver
    )


def solution_of_rows(
    name: str, data: ModelData, system: System, rows: OutputRows, not_unique: tuple[str, ...], message: str,
    notes: tuple[str, ...], solver: dict[str, Any],
) -> Solution:  # fmt: skip
    """Return the channels of rows that no integrator has computed."""
    nothing = np.empty(0)
    return Solution(
        name=name, time=rows.t, channels=channels_of(data, system, rows), outcome=Outcome.DONE, message=message, notes=notes,
        solver=solver, history=History(nothing, np.empty(0, dtype=int)), balance=energy_balance(system, rows, nothing),
        not_unique=not_unique, requested=units(data.outputs()), turns=turns_of(system, rows.q),
    )  # fmt: skip
