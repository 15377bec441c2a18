"""Numerical evaluation of elements at the described poses of the bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reading.joint_name import JointName
from ..reading.marker import MarkerReference
from .element import Element, Joint
from .turns import INITIAL_COUNT, TURN, full_turns

if TYPE_CHECKING:
    from ..model.model_data import ModelData


SAME_POINT = 1e-13
"""Rounding tolerance for coincident points, relative to the mechanism's size or to the coordinates if they are
larger."""


@dataclass(frozen=True)
class InitialPose:
    """Model at its described pose, for checks of the placement of elements."""

    model: ModelData

    def at_one_place(self, i: MarkerReference, j: MarkerReference) -> bool:
        """Return True if two markers coincide at the start, to rounding, so the line through them has no direction."""
        a, b = self.model.point(i), self.model.point(j)
        return math.dist(a, b) <= SAME_POINT * max(self._size, *map(abs, (*a, *b)))

    @cached_property
    def _size(self) -> float:
        """Size of the model, cached because it requires all markers."""
        return self.model.size()


@dataclass(frozen=True, eq=False)
class InitialMarker:
    """Marker with numbers in ground axes: numerical form of `stiffmbs.compile.symbolic.planar_frames.Frame`.

    `point` of shape (2,): m. `angle`: rad.
    """

    point: np.ndarray
    angle: float

    @property
    def axis(self) -> np.ndarray:
        """Unit vector along the marker's axis."""
        return np.array([math.cos(self.angle), math.sin(self.angle)])

    @property
    def normal(self) -> np.ndarray:
        """Unit vector perpendicular to the marker's axis, a quarter turn counter-clockwise."""
        return np.array([-math.sin(self.angle), math.cos(self.angle)])


def initial_element(element: Element, model: ModelData, own_angle: float | None = None) -> Any:
    """Return the element as its equations see it, with numbers for markers, fields and referenced joints.

    `own_angle`: angle with full turns that it counts itself, if known, rad.
    """
    fields = {name: _drawn(getattr(element, name), model) for name in type(element).model_fields}
    return SimpleNamespace(**fields, angle=lambda y, x: _with_turns(math.atan2(y, x), own_angle))


def _with_turns(angle: float, known: float | None) -> float:
    """Return an angle in the turn of a known one, or within half a turn."""
    return angle - TURN * full_turns(angle, INITIAL_COUNT if known is None else known)


def _drawn(value: object, model: ModelData) -> Any:
    match value:
        case MarkerReference():
            return model.initial_marker(value)
        case JointName():
            joint: Joint = model.joint_at_initial_pose(value.joint)
            e, name = initial_element(joint, model), value.coordinate_of(joint)
            e.coordinate = None if name is None else getattr(joint, name)(e)
            known = model.known_angle(f"{value.joint}.{name}") if name is not None and "angle" in name else None
            if known is not None:
                e.coordinate = _with_turns(e.coordinate, known)
            return e
        case _:
            return value


@dataclass(frozen=True, eq=False)
class InitialSpatialMarker:
    """Marker with numbers, in ground axes: its point, m, and its unit axes, each of shape (3,)."""

    point: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray

    @property
    def axes(self) -> np.ndarray:
        """Its unit axes as columns, shape (3, 3)."""
        return np.column_stack((self.x, self.y, self.z))
