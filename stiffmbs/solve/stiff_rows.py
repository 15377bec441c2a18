"""Output rows whose projection onto the constraints has changed stiff forces."""

from __future__ import annotations

from dataclasses import fields, replace
from itertools import repeat
from typing import TypeAlias

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.native.parameters import CONSISTENCY
from ..dynamics.stiff_projection import StiffProjection
from .error_control.newton import stiffness_at
from .trajectory import Trajectory

States: TypeAlias = tuple[np.ndarray, np.ndarray]
"""Positions and velocities, one state per row."""


def with_stiff_forces(
    dynamics: Dynamics, states: States, rows: OutputRows, steps: np.ndarray, rtol: float
) -> OutputRows:
    """Return rows in which projections have changed forces by less than `rtol` of the largest, if possible.

    The solver keeps stiff forces in equilibrium within its tolerance. The smallest move onto the constraints from there
    changes them by any amount. The state of `dynamics` is changed.

    `states` of shapes (n, n_q), (n, n_u): states before the projections, for all rows at least. `steps` of shape (n,):
    lengths of the implicit steps that contain the times, s; 0 for explicit steps, which are short for all forces.
    """
    at = _suspects(dynamics, states, rows, steps, rtol)
    return _projected_again(dynamics, states, rows, at, float(steps.max())) if len(at) else rows


def _suspects(dynamics: Dynamics, states: States, rows: OutputRows, steps: np.ndarray, rtol: float) -> np.ndarray:
    """Return the rows whose projections may have changed a force by more than `rtol` of the largest."""
    moved = np.maximum(rows.drift, rows.changed) > CONSISTENCY.position_tolerance
    at = np.flatnonzero(moved & (steps[: len(rows.t)] > 0.0))
    if not len(at):
        return at
    allowed = rtol * largest_force(dynamics, _of(states, at[-1:]), float(rows.t[at[-1]]))
    at = at[_bounds(dynamics, rows, at) > allowed]
    return at[_changes(dynamics, _of(states, at), rows, at) > allowed] if len(at) else at


def projected(dynamics: Dynamics, t: float, states: States, step: float) -> States:
    """Return q and u at the end of an implicit step, s, projected without a change of stiff forces, if possible.

    The state of `dynamics` is changed. `step`: 0 for an explicit one, whose end stays as it is.
    """
    if not (step and dynamics.system.n_c):
        return states
    q, u = (array.copy() for array in states)
    return (q, u) if _projection(dynamics).project(t, step, q, u) else states


def _projection(dynamics: Dynamics) -> StiffProjection:
    """Return the projection that a system keeps, without pivots of earlier states."""
    projection = dynamics.once(StiffProjection)
    projection.forget_pivots()
    return projection


def lengths_of_steps(trajectory: Trajectory) -> np.ndarray:
    """Return the lengths of the implicit steps that contain the output times, s; zero for explicit steps."""
    ends = np.append(trajectory.t[:1], trajectory.step_times)
    ends = ends[np.diff(ends, prepend=-np.inf) > 0.0]
    if len(ends) < 2 or not trajectory.statistics.get("jacobians"):
        return np.zeros(len(trajectory.t))
    last = np.clip(np.searchsorted(ends, trajectory.t), 1, len(ends) - 1)
    return np.asarray(ends[last] - ends[last - 1])


def _of(states: States, at: np.ndarray) -> States:
    return states[0][at], states[1][at]


def largest_force(dynamics: Dynamics, states: States, t: float) -> float:
    """Return the largest force of an element, or force of inertia, at a state, divided by the root of its inertia."""
    system, state = dynamics.system, dynamics.state
    state.q[:], state.u[:] = states[0][0], states[1][0]
    status, acceleration = dynamics.accelerate(t)
    state.evaluate("motion", t)
    forces = system.term("motion", "f")
    acting = state.values["motion"][forces.source] / np.sqrt(system.mass[forces.row])
    inertia = np.sqrt(system.mass) * acceleration if status == 0 else np.zeros(0)
    return float(np.nanmax(np.abs(np.append(acting, inertia)), initial=0.0))


def _bounds(dynamics: Dynamics, rows: OutputRows, at: np.ndarray) -> np.ndarray:
    """Return bounds of the changes of forces by the projections of some rows, divided by roots of inertias."""
    state = dynamics.state
    state.q[:], state.u[:] = rows.q[at[-1]], rows.u[at[-1]]
    stiffness = stiffness_at(dynamics, float(rows.t[at[-1]]))
    return np.asarray(stiffness.of_positions * rows.moved[at] + stiffness.of_velocities * rows.moved_velocity[at])


def _changes(dynamics: Dynamics, before: States, rows: OutputRows, at: np.ndarray) -> np.ndarray:
    """Return the changes of forces by the projections of some rows, divided by roots of inertias."""
    return _projection(dynamics).force_changes(rows.t[at], before, (rows.q[at], rows.u[at]))


def _projected_again(dynamics: Dynamics, states: States, rows: OutputRows, at: np.ndarray, step: float) -> OutputRows:
    """Return rows of which some are projected without a change of stiff forces, where that changes forces less.

    `step`: longest step, s. Short ones after a restart would weigh inertia as much as stiff forces.
    """
    projection = _projection(dynamics)
    t, (q, u) = rows.t[at], _of(states, at)
    done = np.array([projection.project(*state) for state in zip(t.tolist(), repeat(step), q, u)])
    less = projection.force_changes(t, _of(states, at), (q, u)) < _changes(dynamics, _of(states, at), rows, at)
    at, t, q, u = (array[done & less] for array in (at, t, q, u))
    return _replaced(rows, at, dynamics.report(t, q, u, project=False)) if len(at) else rows


def _replaced(rows: OutputRows, at: np.ndarray, others: OutputRows) -> OutputRows:
    """Return rows of which those at some places are others, apart from the violation before the projection."""
    at, changed = at[: len(others.t)], {}
    for name in (field.name for field in fields(OutputRows) if field.name not in ("t", "drift", "status")):
        changed[name] = getattr(rows, name)
        changed[name][at] = getattr(others, name)
    return replace(rows, **changed)
