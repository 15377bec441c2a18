"""Characteristics of an axle on its rig: toe, camber, track, wheel rate, motion ratio, from the poses of its bodies.

Signs: travel is positive upwards, toe if the wheels point inwards at the front, camber if their tops lean outwards.
Lateral and longitudinal displacements are positive outwards and forwards (ISO 8855 for travel and camber).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...compile.quaternions import rotated
from ...elements.forces.spring_damper import LineSpring
from ...elements.spatial.marker import Marker
from ...model.model_data import ModelData
from ...results.marker_motion import Motions
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
    count = len(next(iter(channels.values())))
    motions = Motions(model, channels, count)
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        spindle, patch = motions.of(axle.at(side, "spindle")), motions.of(axle.at(side, "patch")).point
        wheel, along = spindle.point, rotated(spindle.orientation, np.tile([0.0, 1.0, 0.0], (count, 1)))
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
                ends = [motions.of(marker).point for marker in (spring.i, spring.j)]
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
