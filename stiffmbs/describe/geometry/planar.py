"""Shapes of bodies of the plane."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from ..units import si
from .shape import MeshShape, OneFor, OneOfShapes, PolylineShape, Shape

Point = tuple[si.Length, si.Length]


class Polyline(PolylineShape):
    """A line from point to point; closed, a filled outline."""

    points: tuple[Point, ...] = Field(min_length=2, description="in the body's own axes, m")


class Placed(Shape):
    """Base of the shapes that have a place and a direction."""

    point: Point = Field((0.0, 0.0), description="its middle (of a mesh the origin) in the body's own axes, m")
    angle: si.Angle = Field(0.0, description="its direction against the body's, rad")


class Box(Placed):
    """A rectangle."""

    type: Literal["box"] = "box"
    size: tuple[si.PositiveLength, si.PositiveLength] = Field(description="along its x and y, m")


class Cylinder(Placed):
    """A disc: a cylinder seen from its end."""

    type: Literal["cylinder"] = "cylinder"
    radius: si.PositiveLength = Field(description="m")


class Sphere(Placed):
    """A ball."""

    type: Literal["sphere"] = "sphere"
    radius: si.PositiveLength = Field(description="m")


class Mesh(MeshShape, Placed):
    """Triangles from a file; its z points out of the plane."""


SHAPES = (Polyline, Box, Cylinder, Sphere, Mesh)
PlanarGeometry = Annotated[tuple[Annotated[Any, OneOfShapes(*SHAPES)], ...], OneFor()]
"""The shapes of a body, one after the other; one may stand alone."""
