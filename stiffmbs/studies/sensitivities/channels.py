"""Derivatives of channels: linear ones by their own rules, energies by the product rule, requests by differences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...analyses.job import Job
from ...compile.directional.direction import Numbers
from ...compile.reactions import reactions
from ...compile.system import System
from ...dynamics.dynamics import OutputRows
from ...results.channels import counters, motion_channels, state_channels
from ...results.requests import requested
from ...sensitivity_equations.block_system import Change
from .set_up import SetUp


def changed_channels(
    system: System, u: np.ndarray, numbers: Sequence[Numbers], changes: Sequence[Change], values: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the derivatives of the channels of bodies, elements and energies, each of shape (instants, directions).

    `u` of shape (instants, n_u). `numbers`: numbers of the directions. `values` of shape (instants, directions,
    values): derivatives of the output terms.
    """
    shape = len(changes), len(numbers)
    moved_q, moved_u, moved_a = (
        np.concatenate([getattr(change, name) for change in changes]) for name in ("q", "u", "acceleration")
    )
    channels = motion_channels(system, moved_q, moved_u, moved_a)
    flat = values.reshape(-1, values.shape[-1])
    channels |= state_channels(system, moved_q, flat)
    channels |= reactions(system, flat)
    channels["energy.potential"] = flat[:, system.term("output", "potential").source].sum(axis=1)
    channels = {name: slope.reshape(shape) for name, slope in channels.items()}
    masses = np.array([each.mass for each in numbers])
    kinetic = np.einsum("iu,idu->id", system.mass * u, moved_u.reshape(*shape, -1)) + 0.5 * u**2 @ masses.T
    kinetic += flat[:, system.term("output", "kinetic").source].sum(axis=1).reshape(shape)
    return channels | {"energy.kinetic": kinetic, "energy.total": kinetic + channels["energy.potential"]}


def changed_requests(
    job: Job, set_ups: Sequence[SetUp], rows: OutputRows, channels: Mapping[str, np.ndarray], slopes: Mapping[str, np.ndarray],
    moved_q: np.ndarray,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Return the derivatives of requests, by central differences of their formulas, shape (n, directions).

    `channels`: channels that formulas read, shape (n,). `slopes`: their derivatives, shape (n, directions). `moved_q`
    of shape (n, directions, n_q): derivatives of the coordinates, including revolution counters.
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
