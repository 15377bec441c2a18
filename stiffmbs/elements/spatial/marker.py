"""Spatial markers: points and orientations fixed on a body or on ground."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Final, Literal

from pydantic import Field

from ...reading.fields import Described
from ...reading.marker import MarkerReference
from ...reading.units import si
from .orientation import IDENTITY, Orientation, matrix

Point = si.Point3
ORIGIN: Final = (0.0, 0.0, 0.0)


class Placement(Described):
    """Position and orientation of a named marker on its body."""

    point: Point = Field(ORIGIN, description="position in the body's own axes, from its origin, m")
    orientation: Orientation = Field(IDENTITY, description="orientation of the marker's axes relative to the body's")

    def numbers(self) -> tuple[float, ...]:
        """Return the inputs of kernels: the point, the rotation matrix by rows, and the quaternion."""
        return (*self.point, *(float(part) for part in matrix(self.orientation).ravel()), *self.orientation)


class Marker(MarkerReference):
    """Marker used by an element: a named marker of a body, or an explicit one.

    Written as ``cart`` (the body's origin with its axes), ``bar.end`` (a named marker of the body), ``ground``, or
    ``{body: bar, point: [-300 mm, 0, 0], orientation: {z: [1, 0, 0]}}``.
    """

    dimensions: ClassVar[Literal[3]] = 3
    written_as: ClassVar[Mapping[str, str]] = {
        key: f"orientation: {{{key[0]}: [0, 1, 0]}} or another direction" for key in ("x_axis", "z", "z_axis")
    } | {"axis": "orientation: {z: [0, 1, 0]} or another direction; a joint's axis is z"}

    point: Point = Field(ORIGIN, description="position in the body's own axes, from its origin, m")
    orientation: Orientation = Field(
        IDENTITY, description="orientation of the axes relative to the body's; a joint's axis is z"
    )

    def placement(self) -> Placement:
        return Placement.model_construct(point=self.point, orientation=self.orientation)  # checked already
