"""Channels of a solution: every time history by name."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..compile.reactions import reactions
from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..dynamics.turns import counted_angles
from ..errors import ChannelError
from ..model.model_data import ModelData
from ..reading.did_you_mean import did_you_mean
from ..reading.joint_name import FREE_COORDINATES
from ..reading.names import owner_of
from .frames import in_own_axes
from .joint_angles import joint_angles
from .saved_state import SET_UP


def channels_of(model: ModelData, system: System, rows: OutputRows) -> dict[str, np.ndarray]:
    """Return all channels by name: bodies, joints and forces, energies, constraint violations, requests."""
    channels = motion_channels(system, rows.q, rows.u, rows.acceleration)
    channels |= state_channels(system, rows.q, rows.values)
    channels |= reactions(system, rows.values)
    if (angles := joint_angles(system)) is not None:
        channels |= angles.continuous(rows)
    channels |= channels_of_model(rows)
    if not model.requests:
        return channels
    from .requests import requested

    return channels | requested(model, rows.t, channels, counters(model, system, rows.q))


def motion_channels(system: System, q: np.ndarray, u: np.ndarray, acceleration: np.ndarray) -> dict[str, np.ndarray]:
    """Return positions, velocities and accelerations of the bodies, or their derivatives, by name."""
    of_body = system.of_body
    states = in_own_axes(system, q, u, acceleration)
    labels = of_body.positions, of_body.velocities, of_body.accelerations
    return {
        f"{body}.{name}": state[:, len(names) * k + offset]
        for k, body in enumerate(system.bodies)
        for state, names in zip(states, labels, strict=True)
        for offset, name in enumerate(names)
    }


def channels_of_model(rows: OutputRows) -> dict[str, np.ndarray]:
    """Return the energies and the largest constraint violations."""
    return {
        "energy.kinetic": rows.kinetic, "energy.potential": rows.potential, "energy.total": rows.kinetic + rows.potential,
        "constraint.position": rows.position_violation, "constraint.velocity": rows.velocity_violation,
    }  # fmt: skip


def state_channels(system: System, q: np.ndarray, values: np.ndarray) -> dict[str, np.ndarray]:
    """Return values and rates of states, and the outputs of their equations, by name; a sampled state has no rate.

    `q` of shape (n, n_q). `values`: values of the set ``output``, one row per instant.
    """
    channels = {name: q[:, system.first_state + k] for k, name in enumerate(system.states)}
    without_rate = {name for name, has_none in zip(system.states, system.without_rate, strict=True) if has_none}
    for name, place in system.signals.items():
        if name not in without_rate:  # the signal of an algebraic state is always zero
            channels[f"{name}.rate" if name in channels else name] = values[:, place]
    return channels


def named(channels: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Return a channel by its name.

    Raises ChannelError if there is no such channel; the message names similar ones.
    """
    try:
        return channels[name]
    except KeyError:
        owner = owner_of(str(name))
        near = [other for other in channels if owner_of(other) == owner] or list(channels)[:12]
        raise ChannelError(
            f"found no channel '{name}'{did_you_mean(name, channels)}, expected one such as {', '.join(near)}{as_request(name)}"
        ) from None


def as_request(name: str) -> str:
    """Return a hint for a message if a name that is no channel is a formula, which a request would compute."""
    is_formula = "(" in str(name)
    return f"; a formula becomes a channel as a request of the scene: requests: {{NAME: {name}}}" if is_formula else ""


def series_of(model: ModelData, system: System, rows: OutputRows, name: str) -> np.ndarray:
    """Return one channel; for a joint or force, without computing the others.

    Raises ChannelError if there is no such channel.
    """
    turns = name.rpartition(".")[2] in FREE_COORDINATES and system.of_body.dimensions == 3
    at = -1 if turns else system.reported.get(name, -1)
    return rows.values[:, at] if at >= 0 else named(channels_of(model, system, rows), name)


def turns_of(system: System, q: np.ndarray) -> dict[str, np.ndarray]:
    """Return the revolution counters of angles, rad, by element and number: ``spring/0``. `q` of shape (n, n_q).

    Those of angles between markers also by their text: ``motor/az(bar, ground)``. Also the full turns by which elements
    were reduced when they were set up in a restart: ``bushing/set_up0``.
    """
    angles = list(counted_angles(system)) if system.n_counters else []
    counted = {f"{angle.element}/{angle.number}": q[:, angle.place] for angle in angles}
    in_formulas = (angle for angle in angles if angle.measure not in ("", angle.element))
    counted |= {f"{angle.element}/{angle.measure}": q[:, angle.place] for angle in in_formulas}
    of_elements = ((name, k, n) for name, turns in system.turns_set_up.items() for k, n in enumerate(turns))
    return counted | {f"{name}/{SET_UP}{k}": np.full(len(q), float(n)) for name, k, n in of_elements}


def counters(model: ModelData, system: System, q: np.ndarray) -> dict[str, np.ndarray]:
    """Return the revolution counters of requests, rad, by the text of the angle."""
    names = {name for name, _ in model.angle_counters()}
    return {
        name: q[:, places[0]]
        for group in system.groups
        for name, places in zip(group.names, group.counters, strict=True)
        if name in names
    }
