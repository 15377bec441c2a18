"""Efforts of actuators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...elements.joints.drive import Drive
from ...errors import InputError
from ...model.model_data import ModelData
from ...reading.did_you_mean import instead_of

UNREACHED: Final = 1e-9
"""Largest effort that actuators may leave, relative to the largest effort, or to that of unit accelerations."""


@dataclass(frozen=True)
class Efforts:
    """Efforts of actuators.

    Attributes
    ----------
    actuators : tuple of str
    values : ndarray, shape (actuators,)
        Forces, N, or torques, N m, along their coordinates.
    redundant : int
        Number of combinations of efforts that do not move the mechanism; the values are those of least norm.
    """

    actuators: tuple[str, ...]
    values: np.ndarray
    redundant: int

    def __repr__(self) -> str:
        listed = ", ".join(f"{name} {value:.6g}" for name, value in zip(self.actuators, self.values, strict=True))
        chosen = (
            f"; least norm, as {self.redundant} combination{'s' * (self.redundant > 1)} of them may be chosen freely"
        )
        return f"<Efforts: {listed}{chosen if self.redundant else ''}>"


def coordinates_of_drives(data: ModelData) -> dict[str, str]:
    """Return the joint coordinate that each drive of a joint moves, by the names of drives; a formula has none."""
    found = {}
    for name, drive in data.joints.items():
        if isinstance(drive, Drive):
            coordinate = drive.joint and drive.joint.coordinate_of(data.joints[drive.joint.joint])
            found[name] = f"{drive.joint.joint}.{coordinate}" if drive.joint and coordinate else ""
    return found


def places_of(actuators: tuple[str, ...], places: Mapping[str, int], drives: Mapping[str, str]) -> list[int]:
    """Return the rates along which actuators act; raise an InputError if one is unknown or not along a joint of the tree."""
    found = []
    for name in actuators:
        coordinate = drives.get(name, name)
        if coordinate not in places and name in drives:
            raise InputError(
                f"actuator '{name}': found a drive of {coordinate or 'a formula'}, expected one along a coordinate of a joint in the "
                "spanning tree; choose its coordinate by `independent`"
            )
        if coordinate not in places:
            raise InputError(
                f"actuator '{name}': found no such coordinate or drive{instead_of(name, [*places, *drives])}; an actuator acts along "
                "a coordinate of a joint in the spanning tree (coordinates of `independent` are in it)"
            )
        found.append(places[coordinate])
    return found


def least_efforts(
    actuators: tuple[str, ...], along: np.ndarray, needed: np.ndarray, scale: float, names: tuple[str, ...]
) -> Efforts:
    """Return the efforts of least norm with along^T efforts = needed.

    `along` of shape (actuators, n): rates of the actuators by the independent rates. `needed` of shape (n,). `scale`: size of
    efforts. Raises InputError if the actuators cannot give these efforts.
    """
    values, _, rank, _ = np.linalg.lstsq(along.T, needed, rcond=None)
    missing = needed - along.T @ values
    if np.abs(missing).max(initial=0.0) > UNREACHED * max(scale, float(np.abs(needed).max(initial=0.0))):
        k = int(np.argmax(np.abs(missing)))
        raise InputError(
            f"actuators {', '.join(actuators) or 'none'}: they cannot give these accelerations, an effort of {missing[k]:.6g} along "
            f"{names[k]} is missing; add actuators, or take accelerations that follow from `forward_dynamics`"
        )
    return Efforts(actuators, values, len(actuators) - int(rank))
