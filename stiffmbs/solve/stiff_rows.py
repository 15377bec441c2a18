"""Output rows whose projection onto the constraints has changed stiff forces."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from ..dynamics.dynamics import POSITION_TOLERANCE, Dynamics, OutputRows
from ..dynamics.stiff_projection import StiffProjection
from .error_control.newton import stiffness_at
from .trajectory import Trajectory

STEP_PARTS = 10.0
"""Step of the solver relative to that of the matrix, in which unstable soft forces are small compared with inertia."""


def with_stiff_forces(dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows, rtol: float) -> OutputRows:
    """Return rows in which projections have changed forces by less than `rtol` of the largest, if possible.

    The solver keeps stiff forces in equilibrium within its tolerance. The smallest move onto the constraints from there
    changes them by any amount. Explicit steps are too short for such forces.
    """
    suspects = np.flatnonzero(rows.drift > POSITION_TOLERANCE)
    if not (len(suspects) and trajectory.statistics.get("jacobians") and len(trajectory.step_times)):
        return rows
    with dynamics.state.unchanged():
        allowed = rtol * np.nanmax(np.abs(np.sqrt(dynamics.system.mass) * rows.acceleration))
        suspects = suspects[_bounds(dynamics, trajectory, rows, suspects) > allowed]
        return _projected_again(dynamics, trajectory, rows, suspects, allowed) if len(suspects) else rows


def _bounds(dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows, at: np.ndarray) -> np.ndarray:
    """Return bounds of the changes of forces by the projections of some rows, divided by roots of inertias."""
    system, state = dynamics.system, dynamics.state
    state.q[:], state.u[:] = rows.q[at[-1]], rows.u[at[-1]]
    stiffness = stiffness_at(dynamics, float(rows.t[at[-1]]))
    moved = np.abs(rows.q[at] - trajectory.q[at]) * np.sqrt(system.mass_by_coordinate)
    changed = np.abs(rows.u[at] - trajectory.u[at]) * np.sqrt(system.mass)
    return stiffness.of_positions * moved.max(axis=1) + stiffness.of_velocities * changed.max(axis=1)


def _projected_again(
    dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows, at: np.ndarray, allowed: float
) -> OutputRows:
    """Return rows of which some are projected without a change of stiff forces, where that succeeds."""
    projection = dynamics.kept("stiff projection", None, lambda: StiffProjection(dynamics))
    t, before = rows.t[at], (trajectory.q[at], trajectory.u[at])
    changes = projection.force_changes(t, before, (rows.q[at], rows.u[at]))
    at = at[changes > allowed]
    if not len(at):
        return rows
    t, q, u = rows.t[at], trajectory.q[at].copy(), trajectory.u[at].copy()
    steps = zip(t.tolist(), rates(trajectory, t).tolist(), q, u, strict=True)
    done = np.array([projection.project(*each) for each in steps])
    less = projection.force_changes(t, (trajectory.q[at], trajectory.u[at]), (q, u)) < changes[changes > allowed]
    at, t, q, u = (array[done & less] for array in (at, t, q, u))
    return _replaced(rows, at, dynamics.report(t, q, u, project=False)) if len(at) else rows


def rates(trajectory: Trajectory, t: np.ndarray) -> np.ndarray:
    """Return cj, 1/s, of the matrices at some times."""
    ends = np.unique(np.append(trajectory.t[0], trajectory.step_times))
    last = np.clip(np.searchsorted(ends, t), 1, len(ends) - 1)
    return np.asarray(STEP_PARTS / (ends[last] - ends[last - 1]))


def _replaced(rows: OutputRows, at: np.ndarray, others: OutputRows) -> OutputRows:
    """Return rows of which those at some places are others, apart from the violation before the projection."""
    at, changed = at[: len(others.t)], {}
    for name in (field.name for field in fields(OutputRows) if field.name not in ("t", "drift", "status")):
        changed[name] = getattr(rows, name)
        changed[name][at] = getattr(others, name)
    return replace(rows, **changed)
