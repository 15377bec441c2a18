"""Separate solution of the mechanisms that the presolve found, and assembly of their motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..dynamics.storage import allocated
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..presolve.presolve import Part, parts_of
from ..presolve.relations import independent_coordinates
from .events.restart import restarted
from .settings import may_presolve, traits_of
from .trajectory import Grid, Look, Outcome, ProgressCallback, Solver, Trajectory, in_common


class Subsystem(NamedTuple):
    """A mechanism ready to be solved. `part`: bodies of the whole system that it moves."""

    part: Part
    dynamics: Dynamics
    start: InitialValues


def subsystem_of(part: Part, start: InitialValues, t: float) -> Subsystem:
    """Return the dynamics and start of a subsystem, from the start of the whole system.

    Raises SolverError when its accelerations are not determined.
    """
    dynamics = Dynamics(part.system)
    return Subsystem(part, dynamics, restarted(dynamics, t, *part.reduced(start.q, start.u), project=False))


def leave_out_coordinates(dynamics: Dynamics, t: float) -> None:
    """Reduce the unknowns of integrators to independent coordinates; the state must satisfy the constraints.

    All coordinates stay if none is independent, as an integrator needs an unknown.
    """
    found = independent_coordinates(dynamics.system, dynamics.state, t)
    if found.independent.any():
        dynamics.coordinates = found


def presolved(
    model: ModelData, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings,
    decided: Callable[[Callable[[], bool]], bool],
) -> tuple[Subsystem, ...]:  # fmt: skip
    """Return the mechanisms to solve in place of the whole system; empty if there is one only or presolve is off.

    For implicit solvers, dependent coordinates are eliminated from their dynamics or from those of the whole system.
    If steps are implicit from the start, the spin of axisymmetric bodies is removed from their quaternions. Explicit
    steps would only come closer to their stability limit. `dynamics`: of the whole system, at its start. `decided`: returns
    an earlier decision to begin with implicit steps, or calls the function that makes it.
    """
    if not may_presolve(settings):
        return ()
    traits = traits_of(settings)
    implicit = traits.implicit and (
        not traits.switches or decided(partial(_begins_implicit, dynamics, start, grid, settings))
    )
    travel = (grid.end - grid.start) * start.u if implicit else None
    parts = parts_of(model, dynamics.system, travel, apart=grid.times is not None)
    subsystems = tuple(subsystem_of(part, start, grid.start) for part in parts)
    if traits.implicit:
        for solved in [subsystem.dynamics for subsystem in subsystems] or [dynamics]:
            leave_out_coordinates(solved, grid.start)
    return subsystems


def _begins_implicit(dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> bool:
    """Return True if a solver that may switch starts with implicit steps; False in the plane, where no body spins."""
    if dynamics.system.of_body.dimensions == 2:
        return False
    from .auto import begins_implicit  # check of a planar scene needs no solver

    state = dynamics.state
    q, u = state.q.copy(), state.u.copy()
    found = begins_implicit(dynamics, start, grid, settings)
    state.q[:], state.u[:] = q, u
    return found


def solve_subsystems(
    solve: Solver,
    subsystems: Sequence[Subsystem],
    start: InitialValues,
    grid: Grid,
    settings: RunSettings,
    watch: ProgressCallback,
) -> Trajectory:
    """Solve the mechanisms one after the other; the contract is in `stiffmbs.solve.trajectory`.

    If one stops early or is interrupted, the whole run ends there. The following ones are solved up to that time.
    The monitor of a grid sees the motion of a single mechanism only: that of several is known when all are solved.
    `solve`: for each of them. `start`: of the whole system.
    """
    found: list[Trajectory] = []
    rows: int | None = None
    for k, subsystem in enumerate(subsystems):
        within = grid if grid.times is None or rows is None else grid.up_to(float(grid.times[rows - 1]))
        if grid.monitor:
            alone = len(subsystems) == 1
            within = replace(within, monitor=_of_the_whole(grid.monitor, subsystem, start) if alone else None)
        found.append(
            solve(subsystem.dynamics, subsystem.start, within, settings, _share(watch, grid, k, len(subsystems)))
        )
        rows = len(found[-1].t)
        if rows < 2:
            break
    return _together(subsystems, found, start)


def _of_the_whole(monitor: Look, subsystem: Subsystem, start: InitialValues) -> Look:
    """Return a monitor that shows the motion of a subsystem as that of the whole system."""

    def look(t: np.ndarray, q: np.ndarray, u: np.ndarray) -> None:
        whole = np.tile(start.q, (len(t), 1)), np.tile(start.u, (len(t), 1))
        subsystem.part.put(q, u, *whole)
        monitor(t, *whole)

    return look


def _share(watch: ProgressCallback, grid: Grid, k: int, count: int) -> ProgressCallback:
    """Convert the progress of one of several runs over the same time to overall progress."""
    return lambda t: watch(grid.start + (k * (grid.end - grid.start) + t - grid.start) / count)


def _together(subsystems: Sequence[Subsystem], found: Sequence[Trajectory], start: InitialValues) -> Trajectory:
    """Assemble the motion of the whole system up to the last common time; unsolved bodies stay at the start."""
    rows = min(len(trajectory.t) for trajectory in found) if len(found) == len(subsystems) else 1
    q, u = allocated(rows, len(start.q)), allocated(rows, len(start.u))
    q[:], u[:] = start.q, start.u
    for subsystem, trajectory in zip(subsystems, found, strict=False):
        subsystem.part.put(trajectory.q[:rows], trajectory.u[:rows], q, u)
    ending = next((each for each in found if each.outcome is not Outcome.DONE), found[-1])
    all_recorded = all(each.recorded for each in found)
    recorded = tuple(pieces for each in found for pieces in each.recorded) if all_recorded else ()
    return replace(ending, t=found[0].t[:rows], q=q, u=u, recorded=recorded, **in_common(found))
