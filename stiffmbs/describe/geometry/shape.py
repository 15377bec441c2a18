"""Base of planar and spatial shapes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo, field_validator
from pydantic_core import core_schema

from ..fields import Described
from ..files.files_read import digest_of_file, file_beside
from ..files.quoted import quoted, written
from ..units import si

COLOR = r"^#[0-9a-fA-F]{6}$"
ENDINGS = (".stl", ".obj")
"""Suffixes of supported mesh files."""


class Shape(Described):
    """Shape of a body, in the body's axes.

    Attributes
    ----------
    type : str
        Name of the kind in scenes.
    """

    type: str

    color: str | None = Field(None, description="such as '#336699'; chosen by the drawing unless given")

    @field_validator("color")
    @classmethod
    def _hexadecimal(cls, color: str | None) -> str | None:
        if color is not None and not re.match(COLOR, color):
            raise ValueError(f"found {written(color)}, expected a color such as '#336699'")
        return color

    def placed(self, frame: Any) -> Any:
        """Return the shape of a mirrored part's body; `frame` is the mirror in the body's axes."""
        return frame.placed(self)


class PolylineShape(Shape):
    """Base of planar and spatial polylines."""

    type: Literal["polyline"] = "polyline"
    points: tuple[Any, ...]
    closed: bool = Field(False, description="whether a line leads back; in the plane the inside is then filled")

    def placed(self, frame: Any) -> Any:
        return self.model_copy(update={"points": tuple(frame.to_outside(point) for point in self.points)})


class OneFor:
    """Marker of a list field that also accepts a single entry, which is repeated to the length of the list, or once."""

    def __init__(self, times: int | None = None) -> None:
        self.times = times

    def listed(self, found: Any) -> Any:
        """Return an entry of a scene as a list."""
        return found if isinstance(found, list | tuple) else (found,) * (self.times or 1)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.no_info_before_validator_function(self.listed, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        several = handler(schema)
        return {"anyOf": [several, several["items"] if "items" in several else several["prefixItems"][0]]}


Scale = Annotated[tuple[si.NumberNotZero, si.NumberNotZero, si.NumberNotZero], OneFor(3)]


class MeshShape(Shape):
    """Base of planar and spatial meshes."""

    type: Literal["mesh"] = "mesh"
    file: str = Field(description="a file .stl or .obj, from the folder of the scene on")
    scale: Scale = Field(
        (1.0, 1.0, 1.0), description="metres for one unit of the file, 1e-3 for mm: one number, or along x, y and z"
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

    def placed(self, frame: Any) -> Any:
        signs = (*frame.signs, 1.0)[:3]
        scale = tuple(a * b for a, b in zip(self.scale, signs, strict=True))
        return frame.placed(self).model_copy(update={"scale": scale})


class OneOfShapes:
    """Marker of a field that takes a shape, selected by its ``type``.

    Parameters
    ----------
    *kinds : types of Shape
    """

    def __init__(self, *kinds: type[Shape]) -> None:
        self.kinds = {kind.model_fields["type"].default: kind for kind in kinds}

    def read(self, found: Any, info: ValidationInfo) -> Any:
        """Return the shape given in the scene."""
        if isinstance(found, tuple(self.kinds.values())):
            return found
        if not isinstance(found, dict):
            raise ValueError(f"found {written(found)}, expected a shape such as {{type: sphere, radius: 10 mm}}")
        kind = found.get("type")
        if not isinstance(kind, str) or kind not in self.kinds:
            shown = "no type" if kind is None else f"the type {written(kind)}"
            raise ValueError(f"found {shown}, expected one of {', '.join(self.kinds)}")
        return self.kinds[kind].model_validate(found, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        ways = [
            handler(core_schema.definitions_schema(kind.__pydantic_core_schema__, [])) for kind in self.kinds.values()
        ]
        return {"oneOf": ways}
