"""Fields of bodies with shapes, whose classes are imported where an entry is read."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from ..reading.fields import Described
from .read_by import Context, ReadBy, class_of


class OneFor:
    """Marker of a list field that also accepts a single entry, which is repeated to the length of the list, or once."""

    def __init__(self, times: int | None = None) -> None:
        self.times = times

    def listed(self, found: object) -> object:
        """Return an entry of a scene as a list."""
        return found if isinstance(found, list | tuple) else (found,) * (self.times or 1)

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.listed, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, object]:
        several = handler(schema)
        return {"anyOf": [several, several["items"] if "items" in several else several["prefixItems"][0]]}


def one_of(expected: str, kinds: Callable[[], tuple[type[Described], ...]]) -> ReadBy:
    """Return the marker of a field that takes one of some entries, selected by its ``type``.

    `expected`: example for messages. `kinds`: returns the classes of the entries.
    """

    @cache
    def by_name() -> dict[str, type[Described]]:
        return {kind.model_fields["type"].default: kind for kind in kinds()}

    def read(found: object, context: Context) -> object:
        """Return the entry validated by the class that its type selects."""
        if isinstance(found, kinds()):
            return found
        return class_of(found, by_name(), expected).model_validate(found, context=context)

    return ReadBy(read, lambda schema_of: {"oneOf": [schema_of(kind) for kind in kinds()]})


def _planar_shapes() -> tuple[type[Described], ...]:
    from .shape import SHAPES

    return SHAPES


def _spatial_shapes() -> tuple[type[Described], ...]:
    from .spatial.geometry import SHAPES

    return SHAPES


_EXAMPLE = "a shape such as {type: sphere, radius: 10 mm}"
PlanarGeometry = Annotated[tuple[Annotated[Any, one_of(_EXAMPLE, _planar_shapes)], ...], OneFor()]
"""Shapes of a planar body; a single one needs no list."""
SpatialGeometry = Annotated[tuple[Annotated[Any, one_of(_EXAMPLE, _spatial_shapes)], ...], OneFor()]
"""Shapes of a spatial body."""
