"""Scales of channels for the judgement of errors; channels of one kind have a common scale."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from ..dynamics.storage import release
from ..reading.formula.measured import CHANNELS, unit_of
from ..reading.names import owner_of

MECHANICAL = ("force", "torque")
"""Kinds of channels that are zero if their element does not exist."""
LITTLE, LITTLE_FORCE = 0.1, 1e-2
"""Least size of a body, or of the force or torque of an element, relative to the largest of its kind."""
ROUNDING = 1e-9
"""Difference that counts as rounding of results, relative to a size, or for instants to a length of time."""
FIXED = 1e-8
"""Largest motion that counts as none, in sizes of the mechanism and rad."""
OF_GRAVITY = 1e-2
"""Accelerations below this part of gravity, or of gravity over the mechanism's size, count as that."""
CROSSED = 1e-3
"""Least size of torques relative to forces, and of rotations relative to displacements, at the mechanism's size."""
REQUEST_ROUNDING = 1e-14
"""Part of the largest number of all channels below which a request of unknown unit is only rounding."""
PLACED = {"length": "position", "number": "orientation"}
ON_THEIR_OWN = ("slip", "deflection_x", "deflection_y")
"""Channels of tyres without a common scale."""
_DIMENSIONS = {name: dimension for name, dimension in CHANNELS.items() if name not in ON_THEIR_OWN}
KINDS = {name: PLACED.get(dimension, dimension) for name, dimension in _DIMENSIONS.items()}
KINDS |= dict.fromkeys(("kinetic", "potential", "total"), "energy")
"""Kind of each channel, by the last part of its name."""
UNITS = {KINDS[name]: unit_of(dimension) for name, dimension in _DIMENSIONS.items()} | {"energy": "J"}
TURNING = {
    "angle": "position", "orientation": "position", "angular velocity": "velocity", "angular acceleration": "acceleration",
}  # fmt: skip
"""Kinds with the kind that sets their least size by a length, for mechanisms at rest."""
PLACES = ("position", "angle", "orientation")
"""Kinds that are measured relative to their start values."""


def kind_of(channel: str) -> str:
    """Return the kind of a channel; empty for requests and constraint violations."""
    return KINDS.get(channel.rpartition(".")[2], "") if "." in channel else ""


def _owner(channel: str) -> str:
    """Return the body, element or request whose channels have a common scale."""
    owner = owner_of(channel)
    return channel if owner == "constraint" else owner


def _kind(channel: str, requested: Mapping[str, str]) -> str:
    """Return the kind of a channel; of a request, only if its unit agrees, as ``push.x`` may be a force."""
    kind = kind_of(channel)
    return kind if channel not in requested or requested[channel] == UNITS.get(kind, "") else ""


def scales(
    channels: Mapping[str, np.ndarray],
    size: float,
    requested: Mapping[str, str] = MappingProxyType({}),
    gravity: float = 0.0,
) -> dict[str, float]:
    """Return the size of each channel: the largest value of its body or element, but at least a part of all.

    `size`: size of the mechanism, m. `requested`: channels that are requests, with their units. `gravity`: its magnitude, m/s^2,
    where accelerations are judged. The result: size in the unit of the channel; for requests the largest value of their components; zero where nothing moves or acts.
    """
    own: dict[tuple[str, str], float] = {}
    keys = {name: (_owner(name), _kind(name, requested)) for name in channels}
    for name, values in channels.items():
        key = keys[name]
        origin = values[0] if key[1] in PLACES or name == "energy.potential" else 0.0
        sizes = np.abs(values - origin)
        # A request may have no value (sqrt(-1)) or a pole (1/0) at some times or at all: neither is a size.
        own[key] = max(own.get(key, 0.0), float(sizes.max(initial=0.0, where=np.isfinite(sizes))))
        release(values)
    nothing = REQUEST_ROUNDING * max(own.values(), default=0.0)
    own = {key: value if key[1] or value > nothing else 0.0 for key, value in own.items()}
    largest: dict[str, float] = {}
    for (_, kind), value in own.items():
        largest[kind] = max(largest.get(kind, 0.0), value)
    for kind, least in (
        ("position", FIXED * size), ("angle", FIXED), ("orientation", FIXED),
        ("acceleration", OF_GRAVITY * gravity), ("angular acceleration", OF_GRAVITY * gravity / size),
    ):  # fmt: skip
        largest[kind] = max(largest.get(kind, 0.0), least)
    for kind, of in TURNING.items():
        largest[kind] = max(largest.get(kind, 0.0), CROSSED * largest.get(of, 0.0) / size)
    largest["torque"] = max(largest.get("torque", 0.0), CROSSED * largest.get("force", 0.0) * size)
    parts = {kind: LITTLE_FORCE if kind in MECHANICAL else LITTLE for kind in largest} | {"": 0.0}
    return {name: max(own[key], parts[key[1]] * largest[key[1]]) if key[1] else own[key] for name, key in keys.items()}
