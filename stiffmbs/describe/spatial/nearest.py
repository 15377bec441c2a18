"""Sign of a marker's quaternion for a relative rotation of less than half a turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..marker import GROUND
from .marker import Marker
from .orientation import Quaternion, product

if TYPE_CHECKING:
    from ..model_data import ModelData


def nearest(model: ModelData, i: Marker, j: Marker) -> Marker:
    """Return marker i with the sign of its quaternion that is nearer to the quaternion of marker j.

    The quaternions of bodies are continuous during motion, so a relative rotation can continue beyond half a turn.
    """
    if _product(_quaternion(model, i), _quaternion(model, j)) >= 0:
        return i
    placed = model.place(i)
    return Marker(body=i.body, point=placed.point, orientation=tuple(-part for part in placed.orientation))


def _quaternion(model: ModelData, marker: Marker) -> Quaternion:
    own: Quaternion = model.place(marker).orientation
    return own if marker.body == GROUND else product(model.bodies[marker.body].orientation, own)


def _product(p: Sequence[float], q: Sequence[float]) -> float:
    return sum(a * b for a, b in zip(p, q, strict=True))
