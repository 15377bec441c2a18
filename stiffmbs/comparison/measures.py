"""Error measures of a motion: positions, velocities, or forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..compile.bodies import QUATERNION
from ..errors import InputError
from ..reading.did_you_mean import instead_of
from ..results.scales import kind_of
from ..results.solution import Solution

ROTATION = ".rotation"
"""Suffix of the name that replaces the quaternion of a body in space: the angle between two orientations, rad."""


@dataclass(frozen=True)
class Measure:
    """Channels with a common error measure: their kinds and their unit."""

    kinds: tuple[str, ...]
    unit: str


MEASURES = {
    "positions": Measure(("position", "angle", "orientation"), "m or rad"),
    "velocities": Measure(("velocity", "angular velocity"), "m/s or rad/s"),
    "forces": Measure(("force", "torque"), "N or N m"),
}


def measure_of(name: str) -> Measure:
    """Return a measure by its name. Raises InputError if there is no such measure."""
    if name not in MEASURES:
        raise InputError(f"measure: found '{name}'{instead_of(name, MEASURES)}")
    return MEASURES[name]


def compared(solution: Solution) -> dict[str, tuple[str, ...]]:
    """Return the channels of each measure: of bodies, joints and forces, without requests and non-unique reactions."""
    left_out = {*solution.requested, *solution.not_unique}
    found: dict[str, list[str]] = {name: [] for name in MEASURES}
    for channel in solution.channels:
        kind, (owner, _, ending) = kind_of(channel), channel.rpartition(".")
        if channel in left_out or (kind == "orientation" and ending != QUATERNION[0]):
            continue
        for name, measure in MEASURES.items():
            if kind in measure.kinds:
                found[name].append(owner + ROTATION if kind == "orientation" else channel)
    return {name: tuple(channels) for name, channels in found.items()}


def difference(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Return the difference of two motions over time in a channel, or in the rotation of a body in space."""
    if not name.endswith(ROTATION) or name in one:
        return np.abs(one[name] - other[name])
    body = name.removesuffix(ROTATION)
    p, r = (np.stack([run[f"{body}.{part}"] for part in QUATERNION]) for run in (one, other))
    chord = np.minimum(np.linalg.norm(p - r, axis=0), np.linalg.norm(p + r, axis=0))  # p and -p are one rotation
    return 4 * np.arcsin(np.minimum(chord / 2, 1.0))


def largest(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray], name: str) -> float:
    """Return the largest difference over time, at instants where both have a value; infinite if a number overflowed."""
    apart = difference(one, other, name)
    known = apart[~np.isnan(apart)]
    return float(known.max()) if known.size else np.inf
