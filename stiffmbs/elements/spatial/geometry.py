"""Shapes of spatial bodies."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...reading.units import si
from ..shape import MeshShape, PolylineShape, Shape
from .marker import ORIGIN, Point
from .orientation import IDENTITY, Orientation


class Polyline(PolylineShape):
    """Polyline."""

    points: tuple[Point, ...] = Field(min_length=2, description="in the body's own axes from its origin, m")


class Placed(Shape):
    """Base of the shapes with a position and an orientation."""

    point: Point = Field(ORIGIN, description="its middle (of a mesh the origin) in the body's own axes, m")
    orientation: Orientation = Field(IDENTITY, description="orientation of its axes relative to the body's")


class Box(Placed):
    """Cuboid."""

    type: Literal["box"] = "box"
    size: tuple[si.PositiveLength, si.PositiveLength, si.PositiveLength] = Field(description="along its x, y and z, m")


class Cylinder(Placed):
    """Cylinder about its z axis."""

    type: Literal["cylinder"] = "cylinder"
    radius: si.PositiveLength = Field(description="m")
    length: si.PositiveLength = Field(description="m")


class Sphere(Placed):
    """Sphere."""

    type: Literal["sphere"] = "sphere"
    radius: si.PositiveLength = Field(description="m")


class Mesh(MeshShape, Placed):
    """Triangles from a file."""


SHAPES = (Polyline, Box, Cylinder, Sphere, Mesh)
