"""Separate solution of the mechanisms that the presolve found, and assembly of their motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..dynamics.storage import allocated
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..presolve.presolve import Part, parts_of
from ..presolve.relations import independent_coordinates
from .auto import begins_implicit
from .cost import COSTS, ImplicitCost, of_explicit_step
from .events.restart import restarted
from .explicit.native.parameters import FASTEST_RATE
from .settings import may_presolve, traits_of
from .trajectory import Grid, History, Outcome, ProgressCallback, Solver, Trajectory, summed


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
    together = partial(alike, dynamics, start, (grid.start, grid.end), implicit)
    parts = parts_of(model, dynamics.system, travel, together if grid.times is not None else None)
    subsystems = tuple(subsystem_of(part, start, grid.start) for part in parts)
    if traits.implicit:
        for solved in [subsystem.dynamics for subsystem in subsystems] or [dynamics]:
            leave_out_coordinates(solved, grid.start)
    return subsystems


def _begins_implicit(dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> bool:
    """Return True if a solver that may switch starts with implicit steps; False in the plane, where no body spins."""
    if dynamics.system.of_body.dimensions == 2:
        return False
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
    `solve`: for each of them. `start`: of the whole system.
    """
    found: list[Trajectory] = []
    rows = None if grid.times is None else len(grid.times)
    for k, subsystem in enumerate(subsystems):
        within = grid if rows is None else _up_to(grid, rows)
        found.append(
            solve(subsystem.dynamics, subsystem.start, within, settings, _share(watch, grid, k, len(subsystems)))
        )
        rows = len(found[-1].t)
        if rows < 2:
            break
    return _together(subsystems, found, start)


def _up_to(grid: Grid, rows: int) -> Grid:
    assert grid.times is not None
    if rows == len(grid.times):
        return grid
    return replace(grid, end=float(grid.times[rows - 1]), times=grid.times[:rows])


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
    return replace(
        ending, t=found[0].t[:rows], q=q, u=u, statistics=summed([each.statistics for each in found]), history=_merged([each.history for each in found]),
        note="; ".join(each.note for each in found if each.note),
        solver=", ".join(dict.fromkeys(each.solver for each in found if each.solver)),
        long_steps=tuple(steps for each in found for steps in each.long_steps),
        recorded=tuple(pieces for each in found for pieces in each.recorded) if all(each.recorded for each in found) else (),
        departures=tuple(each for trajectory in found for each in trajectory.departures),
    )  # fmt: skip


def _merged(histories: Sequence[History]) -> History:
    t, order = (np.concatenate(parts) for parts in zip(*((h.t, h.order) for h in histories), strict=True))
    sequence = np.argsort(t, kind="stable")
    return History(t[sequence], order[sequence] if len(order) == len(t) else order)


IMPLICIT_STEPS, EXPLICIT_STEPS = 30.0, 2.0
"""Steps of BDF and of DOP853 per radian of the motion, at rtol 1e-6."""


def alike(
    dynamics: Dynamics,
    start: InitialValues,
    during: tuple[float, float],
    implicit: bool,
    mechanisms: Sequence[np.ndarray],
) -> list[list[int]]:
    """Return the sets of mechanisms to solve together that minimize the estimated cost.

    The fastest mechanism of a set determines its number of steps. Each step has a fixed cost and a cost per unknown.
    Mechanisms with formulas, tables, events or states are solved separately, as each of their breakpoints is a
    restart. `dynamics`: of the whole system. `during`: start and end of the run, s. `implicit`: true if BDF solves it.
    `mechanisms`: body numbers of each mechanism.
    """
    system = dynamics.system
    width = system.of_body.n_u
    label = np.full(system.n_u, -1)
    for k, bodies in enumerate(mechanisms):
        label[(width * bodies[:, None] + np.arange(width)).ravel()] = k
    alone = _with_laws(system)
    smooth = [k for k, bodies in enumerate(mechanisms) if not alone[bodies].any()]
    sets = [[k] for k in range(len(mechanisms)) if k not in smooth]
    if len(smooth) < 2:
        return sets + [[k] for k in smooth]
    rates = _rates(dynamics, during[0], start, label, len(mechanisms))
    whole = ImplicitCost.of(dynamics).step if implicit else of_explicit_step(dynamics)
    itself = COSTS.step_residuals * COSTS.residual if implicit else COSTS.explicit_step
    share = np.bincount(label[label >= 0], minlength=len(mechanisms)) / np.count_nonzero(label >= 0)
    of_unknowns = (whole - itself) * share
    steps = COSTS.start_steps + (IMPLICIT_STEPS if implicit else EXPLICIT_STEPS) * (during[1] - during[0]) * rates
    current: list[int] = []
    for k in sorted(smooth, key=lambda k: -steps[k]):
        more = (steps[current[0]] - steps[k]) * of_unknowns[k] if current else np.inf
        if more < COSTS.start + steps[k] * itself:
            current.append(k)
        else:
            current = [k]
            sets.append(current)
    return sets


def _with_laws(system: System) -> np.ndarray:
    """Return a mask of the bodies with elements that have breakpoints, formulas, tables or states, shape (bodies,)."""
    found = np.zeros(len(system.bodies) + 1, dtype=bool)
    for group in system.groups:
        if group.has_law or group.states.shape[1]:
            found[group.bodies.ravel()] = True
    return found[:-1]


def _rates(dynamics: Dynamics, t: float, start: InitialValues, label: np.ndarray, count: int) -> np.ndarray:
    """Return a characteristic rate of each mechanism at the start, 1/s; infinite where accelerations have no solution.

    It is the largest of the natural angular frequencies, the decay rates, the angular velocities and the square roots
    of the angular accelerations.
    """
    system, state = dynamics.system, dynamics.state
    q, u = start.q, start.u
    state.q[:], state.u[:] = q, u
    status, at_start = dynamics.accelerate(t)
    if status < 0:
        return np.full(count, np.inf)
    moving = label >= 0
    angular = np.zeros(system.n_u, dtype=bool)
    angular.reshape(-1, system.of_body.n_u)[:, system.of_body.linear :] = True
    of_angles = np.where(angular, np.maximum(np.abs(u), np.sqrt(np.abs(at_start))), 0.0)
    found = np.zeros(count)
    np.maximum.at(found, label[moving], of_angles[moving])
    stiffness = _growth(dynamics, t, (q, u), at_start, label, of_pose=True)
    damping = _growth(dynamics, t, (q, u), at_start, label, of_pose=False)
    state.q[:], state.u[:] = q, u
    dynamics.forget_pivots()
    return np.maximum(found, np.maximum(np.sqrt(stiffness), damping))


def _growth(
    dynamics: Dynamics,
    t: float,
    at: tuple[np.ndarray, np.ndarray],
    at_start: np.ndarray,
    label: np.ndarray,
    of_pose: bool,
) -> np.ndarray:
    """Return the norm of the derivative of accelerations by the pose, or by velocities, of each mechanism.

    The power method treats all mechanisms at once, as the accelerations of each depend on its own motion alone.
    """
    (q, u), state, mass = at, dynamics.state, dynamics.system.mass
    own = np.flatnonzero(label >= 0)
    of = label[own]
    count = int(of.max()) + 1

    def largest(v: np.ndarray) -> np.ndarray:
        found = np.zeros(count)
        np.maximum.at(found, of, np.abs(v[own]))
        return np.maximum(found, np.finfo(float).tiny)

    def size(v: np.ndarray) -> np.ndarray:
        return np.sqrt(np.bincount(of, mass[own] * v[own] ** 2, count))

    v = np.zeros(len(u))
    v[own] = np.sin(1.0 + 3.7 * own) / mass[own]
    growth = np.zeros(count)
    for _ in range(FASTEST_RATE.iterations):
        scale = FASTEST_RATE.move / largest(v)
        move = np.zeros(len(u))
        move[own] = scale[of] * v[own]
        state.q[:], state.u[:] = (dynamics.system.of_body.moved(q, move), u) if of_pose else (q, u + move)
        status, acceleration = dynamics.accelerate(t)
        if status < 0:
            return np.full(count, np.inf)
        w = np.zeros(len(u))
        w[own] = (acceleration[own] - at_start[own]) / scale[of]
        before = size(v)
        growth = np.divide(size(w), before, out=np.zeros(count), where=before > 0.0)
        v = w
    return growth
