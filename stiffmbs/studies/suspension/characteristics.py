"""Characteristics of an axle on its rig: toe, camber, track, wheel rate, motion ratio, from the poses of its bodies.

Signs: travel is positive upwards, toe if the wheels point inwards at the front, camber if their tops lean outwards.
Lateral and longitudinal displacements are positive outwards and forwards (ISO 8855 for travel and camber).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...compile.quaternions import rotated
from ...describe.forces.spring_damper import LineSpring
from ...describe.marker import GROUND
from ...describe.model_data import ModelData
from ...describe.spatial.marker import Marker
from .rig import SIDES, Axle

UNITS = {
    "travel": "mm", "toe": "deg", "camber": "deg", "lateral": "mm", "longitudinal": "mm", "load": "N",
    "wheel_rate": "N/mm", "motion_ratio": "",
}  # fmt: skip
"""Characteristics of each wheel, with their units."""


def characteristics(
    model: ModelData, axle: Axle, channels: Mapping[str, np.ndarray], centre: int, lifted: bool
) -> dict[str, np.ndarray]:
    """Return the characteristics of both wheels in one load case.

    Parameters
    ----------
    model : ModelData
    axle : Axle
    channels : mapping of str to ndarray
        Channels of the load case, instants in order.
    centre : int
        Index of the instant from which displacements count.
    lifted : bool
        True if the wheels are lifted, so that there are a wheel rate and a motion ratio.

    Returns
    -------
    dict of str to ndarray
        ``left.travel``, ``left.toe`` ... ``right.camber``, in the units of `UNITS`.
    """
    found: dict[str, np.ndarray] = {}
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        wheel, patch = (point(model, channels, axle.at(side, name)) for name in ("spindle", "patch"))
        along = direction(model, channels, axle.at(side, "spindle"), 1)
        travel, load = wheel[:, 2] - wheel[centre, 2], channels[f"kc.{side}.pad.fz"]
        found |= {
            f"{side}.travel": 1e3 * travel,
            f"{side}.toe": np.degrees(sign * np.arctan2(along[:, 0], along[:, 1])),
            f"{side}.camber": np.degrees(-sign * np.arcsin(along[:, 2])),
            f"{side}.lateral": 1e3 * sign * (patch[:, 1] - patch[centre, 1]),
            f"{side}.longitudinal": 1e3 * (wheel[:, 0] - wheel[centre, 0]),
            f"{side}.load": load,
        }
        if lifted:
            found[f"{side}.wheel_rate"] = 1e-3 * np.gradient(load, travel)
            for name, spring in springs_of(model, getattr(axle, side)):
                ends = [point(model, channels, marker) for marker in (spring.i, spring.j)]
                length = np.linalg.norm(ends[0] - ends[1], axis=1)
                found[f"{side}.motion_ratio.{name}"] = -np.gradient(length, travel)
    return found


def springs_of(model: ModelData, suspension: str) -> list[tuple[str, LineSpring[Marker]]]:
    """Return the springs between points of a suspension, by name; for a rigid axle, those of a side."""
    return [
        (name.removeprefix(suspension)[1:], force)
        for name, force in model.forces.items()
        if name.startswith((f"{suspension}.", f"{suspension}_")) and isinstance(force, LineSpring)
    ]


def point(model: ModelData, channels: Mapping[str, np.ndarray], marker: Marker) -> np.ndarray:
    """Return the position of a marker over time, in ground axes, m, shape (n, 3)."""
    place = model.place(marker)
    if marker.body == GROUND:
        return np.broadcast_to(place.point, (len(next(iter(channels.values()))), 3))
    body = model.bodies[marker.body]
    arm = np.subtract(place.point, body.center_of_mass)  # channels refer to the centre of mass
    centre = np.stack([channels[f"{marker.body}.{axis}"] for axis in "xyz"], axis=1)
    return np.asarray(centre + turned(channels, marker.body, arm))


def direction(model: ModelData, channels: Mapping[str, np.ndarray], marker: Marker, axis: int) -> np.ndarray:
    """Return the direction of an axis (0, 1, 2) of a marker over time, in ground axes, shape (n, 3)."""
    from ...describe.spatial.orientation import matrix

    own = matrix(model.place(marker).orientation)[:, axis]
    if marker.body == GROUND:
        return np.broadcast_to(own, (len(next(iter(channels.values()))), 3))
    return turned(channels, marker.body, own)


def turned(channels: Mapping[str, np.ndarray], body: str, vector: np.ndarray) -> np.ndarray:
    """Transform a vector from a body's own axes to ground axes over time, shape (n, 3)."""
    quaternions = np.stack([channels[f"{body}.q{k}"] for k in range(4)], axis=1)
    return np.asarray(rotated(quaternions, np.broadcast_to(vector, (len(quaternions), 3))))
