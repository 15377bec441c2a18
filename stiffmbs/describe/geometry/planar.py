"""Shapes of planar bodies."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from ..units import si
from .shape import MeshShape, OneFor, OneOfShapes, PolylineShape, Shape

Point = tuple[si.Length, si.Length]


class Polyline(PolylineShape):
    """Polyline; if closed, a filled outline."""

    points: tuple[Point, ...] = Field(min_length=2, description="in the body's own axes, m")


class Placed(Shape):
    """Base of the shapes with a position and a direction."""

    point: Point = Field((0.0, 0.0), description="its middle (of a mesh the origin) in the body's own axes, m")
    angle: si.Angle = Field(0.0, description="its direction against the body's, rad")


class Box(Placed):
    """Rectangle."""

    type: Literal["box"] = "box"
    size: tuple[si.PositiveLength, si.PositiveLength] = Field(description="along its x and y, m")


class Cylinder(Placed):
    """Disc: the end view of a cylinder."""

    type: Literal["cylinder"] = "cylinder"
    radius: si.PositiveLength = Field(description="m")


class Sphere(Placed):
    """Disc: the view of a sphere."""

    type: Literal["sphere"] = "sphere"
    radius: si.PositiveLength = Field(description="m")


class Mesh(MeshShape, Placed):
    """Triangles from a file; its z axis points out of the plane."""


SHAPES = (Polyline, Box, Cylinder, Sphere, Mesh)
PlanarGeometry = Annotated[tuple[Annotated[Any, OneOfShapes(*SHAPES)], ...], OneFor()]
"""Shapes of a body; a single one needs no list."""
