"""Poses of a solution."""

from __future__ import annotations

import numpy as np

from ..analyses.job import Job
from ..results.body_axes import from_own_axes
from ..results.solution import Solution
from ..run_checks.singular_poses import PosesOnTheWay


def poses_of(job: Job, solution: Solution) -> PosesOnTheWay:
    """Return the poses of a solution with their distances from singular ones."""
    system = job.dynamics.system
    names = [f"{body}.{name}" for body in system.bodies for name in system.of_body.positions]
    q = from_own_axes(system, np.column_stack([solution[name] for name in names]))
    behind = np.zeros((len(q), system.n_q - system.n_pose))  # irrelevant, as only J is evaluated
    return PosesOnTheWay(system, solution.time, np.column_stack([q, behind]))
