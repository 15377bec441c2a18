"""Shapes of bodies: bases in the plane and in space, and the planar ones."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator

from ..reading.fields import Described
from ..reading.files.files_read import digest_of_file, file_beside
from ..reading.files.quoted import quoted, written
from ..reading.units import si
from .geometry import OneFor

if TYPE_CHECKING:
    from ..model.parts.frame import Frame

COLOR = r"^#[0-9a-fA-F]{6}$"
ENDINGS = (".stl", ".obj")
"""Suffixes of supported mesh files."""


class Shape(Described):
    """Shape of a body, in the body's axes. `type`: name of the kind in scenes."""

    type: str

    color: str | None = Field(None, description="such as '#336699'; by default chosen by the drawing")

    @field_validator("color")
    @classmethod
    def _hexadecimal(cls, color: str | None) -> str | None:
        if color is not None and not re.match(COLOR, color):
            raise ValueError(f"found {written(color)}, expected a color such as '#336699'")
        return color

    def placed(self, frame: Frame) -> Self:
        """Return the shape of a mirrored part's body; `frame` is the mirror in the body's axes."""
        return frame.placed(self)


class PolylineShape(Shape):
    """Base of planar and spatial polylines."""

    type: Literal["polyline"] = "polyline"
    points: tuple[Any, ...]
    closed: bool = Field(False, description="whether the line is closed; in the plane the inside is then filled")

    def placed(self, frame: Frame) -> Self:
        return self.model_copy(update={"points": tuple(frame.to_outside(point) for point in self.points)})


Scale = Annotated[tuple[si.NumberNotZero, si.NumberNotZero, si.NumberNotZero], OneFor(3)]


class MeshShape(Shape):
    """Base of planar and spatial meshes."""

    type: Literal["mesh"] = "mesh"
    file: str = Field(description="a file .stl or .obj, relative to the folder of the file that names it")
    scale: Scale = Field(
        (1.0, 1.0, 1.0), description="unit of the file in metres, 1e-3 for mm: one number, or along x, y and z"
    )

    @field_validator("file")
    @classmethod
    def _known(cls, file: str, info: ValidationInfo) -> str:
        if Path(file).suffix.lower() not in ENDINGS:
            raise ValueError(f"found '{quoted(file)}', expected a file that ends in {' or '.join(ENDINGS)}")
        if info.context is None:
            return file
        path = file_beside(info.context, file)
        digest_of_file(path)  # records it
        return str(path)

    def placed(self, frame: Frame) -> Self:
        signs = (*frame.signs, 1.0)[:3]
        scale = tuple(a * b for a, b in zip(self.scale, signs, strict=True))
        return frame.placed(self).model_copy(update={"scale": scale})


Point = si.Point2


class Polyline(PolylineShape):
    """Polyline; if closed, a filled outline."""

    points: tuple[Point, ...] = Field(min_length=2, description="corners in the body's own axes, m")


class Placed(Shape):
    """Base of the shapes with a position and a direction."""

    point: Point = Field((0.0, 0.0), description="its middle (of a mesh the origin) in the body's own axes, m")
    angle: si.Angle = Field(0.0, description="its direction relative to the body's axes, rad")


class Box(Placed):
    """Rectangle."""

    type: Literal["box"] = "box"
    size: tuple[si.PositiveLength, si.PositiveLength] = Field(description="lengths along its x and y, m")


class Cylinder(Placed):
    """Disc: the end view of a cylinder."""

    type: Literal["cylinder"] = "cylinder"
    radius: si.PositiveLength = Field(description="radius, m")


class Sphere(Placed):
    """Disc: the view of a sphere."""

    type: Literal["sphere"] = "sphere"
    radius: si.PositiveLength = Field(description="radius, m")


class Mesh(MeshShape, Placed):
    """Triangles from a file; its z axis points out of the plane."""


SHAPES = (Polyline, Box, Cylinder, Sphere, Mesh)
