"""How large each channel is for an error in it to matter: channels of one kind are measured together."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from ..describe.parts.names import owner_of

SMALL = {"force": 1e-2, "torque": 1e-2}
LITTLE = 0.1
"""Part of the largest of a kind that an element or body counts for at the least: who asks for the force of a small
bushing wants it, but a body that hardly moves is not looked at for its motion."""
FIXED = 1e-8
"""Motions smaller than this, in sizes of the mechanism and rad, are no motions."""
CROSSED = 1e-3
"""The same for torques beside forces, and for rotations beside motions, at the size of the mechanism."""
REQUEST_ROUNDING = 1e-14
"""Part of the largest number of all channels below which a request, whose unit nobody knows, is nothing but rounding."""
MEASURED = {
    "position": "x y z deflection", "angle": "angle slip_angle camber", "orientation": "q0 q1 q2 q3", "velocity": "vx vy vz",
    "angular velocity": "omega wx wy wz", "acceleration": "ax ay az", "angular acceleration": "alpha wdx wdy wdz",
    "force": "fx fy fz longitudinal lateral load", "torque": "torque tx ty tz overturning rolling aligning", "energy": "kinetic potential total",
}  # fmt: skip
KINDS = {ending: kind for kind, endings in MEASURED.items() for ending in endings.split()}
UNITS = {
    "position": "m", "angle": "rad", "velocity": "m/s", "angular velocity": "rad/s", "acceleration": "m/s^2",
    "angular acceleration": "rad/s^2", "force": "N", "torque": "N m", "energy": "J",
}  # fmt: skip
TURNING = {
    "angle": "position", "orientation": "position", "angular velocity": "velocity", "angular acceleration": "acceleration",
}  # fmt: skip
"""Kinds that follow from others by a length: at rest in one of them, the other says what is small."""
PLACES = ("position", "angle", "orientation")
"""Kinds that are measured from where they are at the start."""


def kind_of(channel: str) -> str:
    """What a channel measures; nothing for requests and constraint violations."""
    return KINDS.get(channel.rpartition(".")[2], "") if "." in channel else ""


def _owner(channel: str) -> str:
    """The body, element or request whose channels are measured together."""
    owner = owner_of(channel)
    return channel if owner == "constraint" else owner


def _kind(channel: str, requested: Mapping[str, str]) -> str:
    """The kind of a channel; of a request whose name and unit both say so: ``push.x`` may be a force."""
    kind = kind_of(channel)
    return kind if channel not in requested or requested[channel] == UNITS.get(kind, "") else ""


def scales(
    channels: Mapping[str, np.ndarray], size: float, requested: Mapping[str, str] = MappingProxyType({})
) -> dict[str, float]:
    """The size of each channel: of what its body or element does in all directions, at least a little of the largest.

    Parameters
    ----------
    channels : mapping of str to ndarray
    size : float
        Of the mechanism, m.
    requested : mapping of str to str
        The channels that are requests, with their units.

    Returns
    -------
    dict of str to float
        In the unit of the channel; of requests the largest value of their components; zero where nothing moves or acts.
    """
    own: dict[tuple[str, str], float] = {}
    kinds = {name: _kind(name, requested) for name in channels}
    for name, values in channels.items():
        kind = kinds[name]
        origin = values[0] if kind in PLACES or name == "energy.potential" else 0.0
        key = (_owner(name), kind)
        own[key] = max(own.get(key, 0.0), float(np.nanmax(np.abs(values - origin))))
    nothing = REQUEST_ROUNDING * max(own.values(), default=0.0)
    own = {key: value if key[1] or value > nothing else 0.0 for key, value in own.items()}
    largest: dict[str, float] = {}
    for (_, kind), value in own.items():
        largest[kind] = max(largest.get(kind, 0.0), value)
    for kind, unit in (("position", size), ("angle", 1.0), ("orientation", 1.0)):
        largest[kind] = max(largest.get(kind, 0.0), FIXED * unit)
    for kind, of in TURNING.items():
        largest[kind] = max(largest.get(kind, 0.0), CROSSED * largest.get(of, 0.0) / size)
    largest["torque"] = max(largest.get("torque", 0.0), CROSSED * largest.get("force", 0.0) * size)
    return {
        name: max(own[key], SMALL.get(key[1], LITTLE) * largest[key[1]]) if key[1] else own[key]
        for name in channels
        for key in [(_owner(name), kinds[name])]
    }
