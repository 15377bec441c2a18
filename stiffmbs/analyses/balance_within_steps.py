"""Energy balance by a quadrature within each step of the solver, from a repeated run with rows at its nodes."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.polynomial import legendre

from ..dynamics.dynamics import OutputRows
from ..results.energy_balance import Balance, balance_of_steps, energy_balance
from ..results.energy_balance_notes import PER_TOLERANCE, is_broken
from ..solve.error_control.tolerances import absolute_tolerances
from ..solve.missing_rows import reported
from ..solve.sampling import restarts
from ..solve.settings import near_constraints, traits_of
from ..solve.trajectory import SAME_TIME, Outcome, Trajectory
from .job import Job

NODES = 5, 9
"""Nodes of the quadrature in a step; more are used if the balance does not close. They are exact to degrees 7 and 15."""
MOST_NUMBERS = 1_000_000
"""Numbers in the rows of the repeated run; steps of a longer run are examined from its start as far as these allow."""
INSIDE: Final = 1e-6
"""Distance of the outer nodes from the ends of a step, in steps: there, rows belong to this step on both sides of a restart."""
SHORTEST: Final = 1000.0
"""Length of the shortest examined step, in roundings of time: a restart begins with steps that do no work."""
APART: Final = 4.0
"""Distance of the outer nodes from a restart, in distances within which a time may count as that of the restart."""


def balance_within_steps(job: Job, trajectory: Trajectory, rows: OutputRows) -> tuple[Balance, OutputRows] | None:
    """Return the balance of a run by quadratures in its steps, and the rows at their nodes; None without known steps.

    Other numbers of nodes are tried while it is broken. If the first part of a long run is not, the balance at output times is
    returned with the energy that this part exchanges.
    """
    found, job = None, job.of_one_solver(trajectory)
    for nodes in NODES:
        steps = _steps(job, trajectory, rows, nodes)
        again: OutputRows | None = _at_nodes(job, steps, nodes) if len(steps) else None
        if again is None:
            return found
        balance = balance_of_steps(job.dynamics.system, again, *_weights_and_jumps(job, steps, again, nodes))
        if not is_broken(job.dynamics.system, balance, again, job.settings):
            if rows.t[-1] - steps[-1, 1] <= SHORTEST * np.spacing(rows.t[-1]):
                return balance, again
            first = energy_balance(
                job.dynamics.system, rows
            )  # its scale may miss what is exchanged between output times
            return replace(first, scale=max(first.scale, balance.scale)), rows
        found = balance, again
    return found


def _steps(job: Job, trajectory: Trajectory, rows: OutputRows, nodes: int) -> np.ndarray:
    """Return begin and end of each step within the rows of a run, shape (n, 2); of the first ones, if there are many."""
    start, end = float(rows.t[0]), float(rows.t[-1])
    known = trajectory.step_times
    inside = known[(known > start) & (known < end)]
    if not len(known) and traits_of(job.settings).exact:  # the motion between outputs is as exact as at them
        inside = np.linspace(start, end, int(trajectory.statistics["steps"]) + 1)[1:-1]
    elif not len(known):
        return np.empty((0, 2))
    edges = np.concatenate([[start], np.unique(inside), [end]])
    steps = np.stack([edges[:-1], edges[1:]], axis=1)
    shortest = max(SHORTEST * np.spacing(max(abs(start), abs(end))), 4.0 * APART * _aside(job))
    steps = steps[np.diff(edges) > shortest]
    width = job.dynamics.system.n_q + 3 * job.dynamics.system.n_u + rows.values.shape[1]
    most = max(MOST_NUMBERS // (width * nodes), 1)
    return steps[:most]


def _lobatto(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes and weights of Gauss-Lobatto quadrature over the interval from 0 to 1.

    Davis and Rabinowitz, Methods of Numerical Integration (1984), sec. 2.7.
    """
    polynomial = np.append(np.zeros(nodes - 1), 1.0)
    inner = legendre.legroots(legendre.legder(polynomial))
    x = np.concatenate([[-1.0], np.sort(inner.real), [1.0]])
    return 0.5 * (x + 1.0), 1.0 / (nodes * (nodes - 1) * legendre.legval(x, polynomial) ** 2)


def _aside(job: Job) -> float:
    """Return the distance from a restart within which a time may count as that of the restart, s.

    Steps begin next to a breakpoint, and a sample is at an output time next to it.
    """
    system = job.dynamics.system
    periods = system.sampling[system.sampled, 0]
    return max(job.grid.aside, SAME_TIME * float(np.max(periods, initial=0.0)))


def _inside(job: Job, steps: np.ndarray) -> np.ndarray:
    """Return the distance of the outer nodes from the ends of each step, in steps, shape (n, 1)."""
    return np.maximum(INSIDE, APART * _aside(job) / np.diff(steps))


def _at_nodes(job: Job, steps: np.ndarray, nodes: int) -> OutputRows | None:
    """Return the rows at the nodes of steps, from a repeated run; None if it ends earlier."""
    inside = _inside(job, steps)
    times = (steps[:, :1] + np.diff(steps) * (inside + (1.0 - 2.0 * inside) * _lobatto(nodes)[0])).ravel()
    if not (np.diff(times) > 0).all() or not times[0] > job.grid.start:
        return None
    trajectory = job.varied(times=np.concatenate([[job.grid.start], times, [steps[-1, 1]]])).integrate()
    found, _ = reported(job.dynamics, trajectory, near_constraints(job.settings), job.settings.rtol)
    if trajectory.outcome is not Outcome.DONE or len(found.t) != len(times) + 2:
        return None
    return found.at(np.arange(1, len(times) + 1))


def _weights_and_jumps(job: Job, steps: np.ndarray, rows: OutputRows, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights of the nodes of each step, s, and whether velocities jump between two steps.

    They may jump by any amount at a restart by inputs. Other jumps are those of more than the tolerance.
    """
    weights = np.diff(steps) * (1.0 - 2.0 * _inside(job, steps)) * _lobatto(nodes)[1]
    u, t = rows.u.reshape(len(steps), nodes, -1), rows.t.reshape(len(steps), nodes)
    before, after = u[:-1, -1], u[1:, 0]
    system = job.dynamics.system
    allowed = absolute_tolerances(system, job.settings)[system.n_q :] + job.settings.rtol * np.abs(before)
    beyond = (np.abs(after - before) > PER_TOLERANCE * allowed).any(axis=1)
    first, last = np.searchsorted(restarts(job.dynamics, job.grid), (t[:-1, -1], t[1:, 0]))
    return weights, beyond | (last > first)
