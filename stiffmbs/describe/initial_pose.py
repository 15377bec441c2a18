"""Elements with the numbers of the bodies' described poses in place of symbols: mechanisms at the initial pose."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from .element import Element, Joint
from .joint_name import JointName
from .marker import MarkerReference

if TYPE_CHECKING:
    from .model_data import ModelData

SAME_POINT = 1e-13
"""Of the mechanism's size, or of the coordinates where they are larger: what two ways to one point may differ by."""


@dataclass(frozen=True)
class InitialPose:
    """A model as described, for all its elements that look whether they can stand in it.

    Attributes
    ----------
    model : ModelData
    """

    model: ModelData

    def at_one_place(self, i: MarkerReference, j: MarkerReference) -> bool:
        """Whether two markers are at one point at the start, to rounding: the line through them has no direction."""
        a, b = self.model.point(i), self.model.point(j)
        return math.dist(a, b) <= SAME_POINT * max(self._size, *map(abs, (*a, *b)))

    @cached_property
    def _size(self) -> float:
        """Worked out once, as it looks at all markers."""
        return self.model.size()


@dataclass(frozen=True)
class InitialMarker:
    """A marker with numbers, in ground axes: what `stiffmbs.compile.symbolic.planar_frames.Frame` is with symbols.

    Attributes
    ----------
    point : ndarray, shape (2,)
        m.
    angle : float
        rad.
    """

    point: np.ndarray
    angle: float

    @property
    def axis(self) -> np.ndarray:
        """Unit vector along the marker's axis."""
        return np.array([math.cos(self.angle), math.sin(self.angle)])

    @property
    def normal(self) -> np.ndarray:
        """Unit vector across the marker's axis, a quarter turn ahead of it."""
        return np.array([-math.sin(self.angle), math.cos(self.angle)])


def initial_element(element: Element, model: ModelData) -> Any:
    """The element as its equations see it, for markers, numbers and joints that it refers to."""
    fields = {name: _drawn(getattr(element, name), model) for name in type(element).model_fields}
    return SimpleNamespace(**fields, angle=math.atan2)


def _drawn(value: Any, model: ModelData) -> Any:
    match value:
        case MarkerReference():
            return model.initial_marker(value)
        case JointName():
            joint: Joint = model.joints[value.joint]
            e, name = initial_element(joint, model), value.coordinate_of(joint)
            e.coordinate = None if name is None else getattr(joint, name)(e)
            return e
        case _:
            return value
