"""Checks of stiff forces: of their digits, and in long steps of BDF of order 1, as after restarts at loose tolerances."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.storage import blocks, release
from ..solve.error_control.newton import stiffness_at
from ..solve.stiff_rows import largest_force, lengths_of_steps
from ..solve.trajectory import Trajectory
from .lost_digits import lost_digits_sentence
from .parameters import RUN_CHECKS


def uncertain_forces(dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows) -> Iterator[str]:
    """Yield sentences on forces of a run with implicit steps that are known to a few digits only; the state is changed."""
    if trajectory.statistics.get("jacobians"):
        yield from lost_digits_sentence(dynamics, rows)
        if not trajectory.recorded:  # the estimate from recorded steps includes these errors
            yield from coarse_forces_sentence(dynamics, trajectory, rows)


def coarse_forces_sentence(dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows) -> Iterator[str]:
    """Yield a sentence on stiff forces in long steps of order 1, if they contradict the motion; the state is changed.

    There they follow from second differences of positions, which are no accelerations where the step changes (Gear,
    Hsu and Petzold 1981, Differential-algebraic equations revisited). Accelerations then differ from the mean rate of
    velocities since the output before, at most a step earlier. The difference counts relative to the largest force.
    """
    ends, orders = trajectory.history.t, trajectory.history.order
    if len(orders) != len(ends) or len(rows.t) < 2 or not (orders == 1).any():
        return
    last = np.clip(np.searchsorted(ends, rows.t), 0, len(ends) - 1)
    at = 1 + np.flatnonzero(orders[last[1:]] == 1)
    if not len(at):
        return
    lengths = lengths_of_steps(trajectory)[at]
    within = (lengths > 0.0) & (lengths >= np.diff(rows.t)[at - 1])
    at, lengths = at[within], lengths[within]
    if not len(at):
        return
    mass, rate = dynamics.system.mass, (rows.u[at] - rows.u[at - 1]) / (rows.t[at] - rows.t[at - 1])[:, None]
    inertia = _largest_inertia(rows, mass)
    off = np.sqrt((rows.acceleration[at] - rate) ** 2 @ mass)
    found = off > RUN_CHECKS.contradicted_part * inertia
    at, off, lengths = at[found], off[found], lengths[found]
    if not len(at):
        return
    last = at[-1:]
    largest = max(inertia, largest_force(dynamics, (rows.q[last], rows.u[last]), float(rows.t[last[0]])))
    found = off > RUN_CHECKS.contradicted_part * largest
    at, off, lengths = at[found], off[found] / largest, lengths[found]
    if not len(at):
        return
    dynamics.state.q[:], dynamics.state.u[:] = rows.q[at[-1]], rows.u[at[-1]]
    long = lengths > stiffness_at(dynamics, float(rows.t[at[-1]])).long_step
    if long.any():
        at, off = at[long], off[long]
        yield (
            f"stiff forces and reactions are wrong by up to about {100.0 * off.max():.2g} % of the largest at {len(at)} output "
            f"time{'s' * (len(at) > 1)} from t = {rows.t[at[0]]:.6g} s on: steps of BDF of order 1 are long for them there; "
            "reduce rtol, or use solver: radau"
        )


def _largest_inertia(rows: OutputRows, mass: np.ndarray) -> float:
    """Return the largest force of inertia at an output time, divided by the root of its inertia."""
    largest = 0.0
    for block in blocks(len(rows.t)):
        largest = max(largest, float(np.fmax.reduce(rows.acceleration[block] ** 2 @ mass)))
        release(rows.acceleration)
    return float(np.sqrt(largest))
