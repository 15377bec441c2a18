"""Joint conditions at the start alone: initial conditions of joints (Adams/Solver, JOINT statement, IC)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import consistent_values, initial_values
from ..model.scene import Scene
from ..model.settings import RunSettings


def hold_at_start(dynamics: Dynamics, scene: Scene, t: float) -> None:
    """Move the current state by the least amount to satisfy the joints that hold at the start alone, at t = `t` s.

    Position equations constrain positions alone, velocity equations velocities: a position drive leaves the velocity
    free.  Raise an AssemblyError if no such state is found.
    """
    from .job import examined

    held = scene.held_at_start
    if held is None:
        return
    found = examined(held, RunSettings(start=t))
    placed = initial_values(found.dynamics(), t)
    system, names = found.redundancy.system, {*scene.at_start}
    of_start = np.array([name in names for name, _ in system.equations], dtype=bool)
    active = np.where(of_start, ~system.holonomic, found.redundancy.active)
    moving = Dynamics(replace(system, active=active, q=placed.q))
    velocities = consistent_values(moving, t).u
    n_pose = dynamics.system.n_pose
    dynamics.state.q[:n_pose], dynamics.state.u[:] = placed.q[:n_pose], velocities
