"""Markers (Adams: MARKER): points and directions fixed on a body or on ground.

Planar and spatial markers share the reference to a body; their placements differ.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol, TypeVar

from pydantic import Field, GetJsonSchemaHandler, ValidationInfo, model_validator
from pydantic_core import CoreSchema

from .did_you_mean import did_you_mean
from .fields import DOTTED_PATTERN, Described
from .files.quoted import written
from .handle import Handle
from .names import GROUND as GROUND
from .names import names_of
from .units import si

if TYPE_CHECKING:
    from ..elements.body import AnyBody
    from ..elements.element import Element

_REFERENCE = {"type": "string", "description": "a body ('cart'), a marker of a body ('bar.end'), or 'ground'"}


class Placement(Described):
    """Position and direction of a named marker on its body."""

    point: si.Point2 = Field((0.0, 0.0), description="position in the body's own axes, from its centre of mass, m")
    angle: si.Angle = Field(0.0, description="direction of the marker's axis relative to the body's, rad")

    def numbers(self) -> tuple[float, ...]:
        """Return the inputs of kernels: the point, the angle, its cosine and its sine."""
        return (*self.point, self.angle, math.cos(self.angle), math.sin(self.angle))


class MarkerReference(Described):
    """Body, or named marker of a body: ``cart``, ``bar.end``, ``ground``.

    `dimensions`: 2 or 3; None for one of either family.
    """

    dimensions: ClassVar[int | None] = None

    body: str = Field(description="a body of the scene, or ground")
    marker: str | None = Field(None, pattern=DOTTED_PATTERN, description="a marker that the body names")

    @model_validator(mode="before")
    @classmethod
    def _from_reference(cls, found: object, info: ValidationInfo) -> object:
        names = names_of(info)
        if isinstance(found, Handle):
            return {"body": found.name}
        if isinstance(found, dict) and isinstance(found.get("body"), Handle):
            found = {**found, "body": found["body"].name}
        if isinstance(found, str):
            mount, _, named = found.partition(".")
            if mount in names.mounts:
                return {"body": mount, "marker": named or None}  # resolved with the part
            body, marker = names.body_and_marker(found)
            return {"body": body, "marker": marker or None}
        if isinstance(found, dict) and isinstance(found.get("body"), str) and found["body"] not in names.mounts:
            found = {**found, "body": names.full(found["body"])}
        if (
            isinstance(found, dict)
            and found.get("marker")
            and (found.keys() - {"body", "marker"}) & cls.model_fields.keys()
        ):
            raise ValueError("found a marker's name and a point, expected one or the other")
        if not isinstance(found, dict | MarkerReference):
            raise ValueError(f"found {written(found)}, expected a body, body.marker, or a mapping with body and point")
        return found

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, object]:
        return {"anyOf": [_REFERENCE, handler(core_schema)]}

    def placement(self) -> Any:
        """Return the explicit placement on the body; None for a reference by name."""
        return None

    @property
    def label(self) -> str:
        """Name in messages: ``body.marker``, or the body alone."""
        return f"{self.body}.{self.marker}" if self.marker else self.body


M = TypeVar("M", bound=MarkerReference)
"""Marker of an element that is the same in the plane and in space."""


class Marker(MarkerReference):
    """Marker used by an element: a named marker of a body, or an explicit one.

    Written as ``cart`` (the centre of mass), ``bar.end`` (a named marker of the body), ``ground``, or ``{body: bar,
    point: [-300 mm, 0], angle: 90 deg}``.
    """

    dimensions: ClassVar[Literal[2]] = 2

    point: si.Point2 = Field((0.0, 0.0), description="position in the body's own axes, m")
    angle: si.Angle = Field(0.0, description="direction of the axis relative to the body's, rad")

    def placement(self) -> Placement:
        return Placement.model_construct(point=self.point, angle=self.angle)  # checked already


def check_marker(
    where: str, marker: MarkerReference, bodies: Mapping[str, AnyBody], on_ground: Mapping[str, object]
) -> None:
    """Refuse a marker on an unknown body, or a marker name that its body does not have."""
    if marker.body != GROUND and marker.body not in bodies:
        of_parts = any(f".{marker.body}." in f".{name}" for name in bodies)  # such as the nodes of a beam
        name = marker.label if of_parts else marker.body
        known = {each: body for each, body in bodies.items() if body.rigid}  # no frames and modes of flexible bodies
        raise ValueError(
            f"{where}: found the unknown body '{name}'{did_you_mean(name, known)}, expected {listed(known)}"
        )
    own = on_ground if marker.body == GROUND else bodies[marker.body].markers
    if marker.marker is not None and marker.marker not in own:
        near = did_you_mean(marker.marker, own)
        raise ValueError(
            f"{where}: found '{marker.label}'{near}, expected one of its markers ({', '.join(own) or 'none'})"
        )


def listed(bodies: Mapping[str, object]) -> str:
    """Return the names of bodies as a list for a message."""
    names = list(bodies)
    return ", ".join([*names[:8], *(["..."] if len(names) > 8 else []), GROUND])


class Carries(Protocol):
    """Model that provides the placement of markers, also with merged bodies."""

    def carried(self, marker: object) -> tuple[str, Any]:
        """Return the body that carries a marker, and the placement on it."""


class PlacedMarkers(dict[MarkerReference, tuple[str, tuple[float, ...]]]):
    """Body and kernel inputs of the placement of each marker; those of `elements` are listed from the start.

    A marker that was not listed, such as a body's axes in a formula, is added on access.
    """

    def __init__(self, model: Carries, elements: Iterable[Element] = ()) -> None:
        super().__init__()
        self._model = model
        for element in elements:
            for _, marker in element.markers():
                self[marker]

    def __missing__(self, marker: MarkerReference) -> tuple[str, tuple[float, ...]]:
        body, placed = self._model.carried(marker)
        self[marker] = found = body, placed.numbers()
        return found
