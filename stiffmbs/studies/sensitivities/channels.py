"""How channels change where the state changes: linear ones by their own rules, energies by the product rule, requests by differences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...compile.directional.direction import Numbers
from ...compile.reactions import reactions
from ...compile.system import System
from ...jobs.run import Job
from ...results.body_axes import in_own_axes
from ...results.channels import counters
from ...results.requests import requested
from ...results.states import state_channels
from ...solve.dynamics import OutputRows
from ...solve.variations.block_system import Change
from .set_up import SetUp


def changed_channels(
    system: System, u: np.ndarray, numbers: Sequence[Numbers], change: Change, values: np.ndarray
) -> dict[str, np.ndarray]:
    """How the channels of bodies, elements and energies change at one instant, each of shape (directions,).

    Parameters
    ----------
    system : System
    u : ndarray, shape (n_u,)
    numbers : sequence of Numbers
    change : Change
    values : ndarray, shape (directions, values)
        How the output terms change.
    """
    of_body, channels = system.of_body, dict[str, np.ndarray]()
    states = in_own_axes(system, change.q, change.u, change.acceleration)
    labels = of_body.positions, of_body.velocities, of_body.accelerations
    for k, body in enumerate(system.bodies):
        for state, names in zip(states, labels, strict=True):
            for offset, name in enumerate(names):
                channels[f"{body}.{name}"] = state[:, len(names) * k + offset]
    channels |= state_channels(system, change.q, values)
    channels |= reactions(system, values)
    masses = np.array([each.mass for each in numbers])
    kinetic = change.u @ (system.mass * u) + 0.5 * masses @ u**2
    potential = values[:, system.term("output", "potential").source].sum(axis=1)
    channels |= {"energy.kinetic": kinetic, "energy.potential": potential, "energy.total": kinetic + potential}
    return channels


def changed_requests(
    job: Job, set_ups: Sequence[SetUp], rows: OutputRows, channels: Mapping[str, np.ndarray], slopes: Mapping[str, np.ndarray],
    moved_q: np.ndarray,
) -> dict[str, np.ndarray]:  # fmt: skip
    """How requests change, by central differences of their formulas, shape (n, directions).

    Parameters
    ----------
    job : Job
    set_ups : sequence of SetUp
    rows : OutputRows
    channels : mapping of str to ndarray
        What formulas read, shape (n,).
    slopes : mapping of str to ndarray
        How that changes, shape (n, directions).
    moved_q : ndarray, shape (n, directions, n_q)
        How coordinates change, of which some count turns.
    """
    columns = []
    for k, set_up in enumerate(set_ups):
        found = []
        for scene, shift in zip(set_up.scenes, set_up.shifts, strict=True):
            there = {name: channels[name] + shift * slope[:, k] for name, slope in slopes.items()}
            counted = counters(scene, job.dynamics.system, rows.q + shift * moved_q[:, k])
            found.append(requested(scene, rows.t, there, counted))
        columns.append({name: set_up.derivative([values[name] for values in found]) for name in found[0]})
    return {name: np.column_stack([column[name] for column in columns]) for name in columns[0]}
