"""Roads as fields of elements, by name or by value, and the section of a scene that names them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic import ValidationError as PydanticError
from pydantic_core import core_schema

from ...errors import InputError
from ..fields import NAME_PATTERN, sentence
from ..files.quoted import quoted, written
from .road import Road

ROADS: Mapping[str, str] = MappingProxyType(
    {
        "flat": "flat:FlatRoad",
        "formula": "formula:FormulaRoad",
        "table": "profile:TableRoad",
        "grid": "grid:GridRoad",
        "crg": "crg:CrgRoad",
        "step": "step:StepRoad",
        "cosine_bump": "cosine_bump:CosineBump",
        "sine_sweep": "sine_sweep:SineSweep",
        "iso8608": "iso8608:Iso8608Road",
    }
)
"""File and class of each kind of road, imported on demand."""


def kind_of_road(kind: str) -> type[Road]:
    """Return the class of a kind of road."""
    file, _, name = ROADS[kind].partition(":")
    road: type[Road] = getattr(import_module(f".{file}", __package__), name)
    return road


def read_road(found: object, context: Mapping[str, Any] | None) -> Road:
    """Return the road of a field."""
    if isinstance(found, Road):
        return found
    if isinstance(found, str):
        known = (context or {}).get("roads") or {}
        if found not in known:
            raise ValueError(f"found the unknown road '{quoted(found)}', expected one of {', '.join(known) or 'none'}")
        return known[found]  # type: ignore[no-any-return]
    if not isinstance(found, dict):
        raise ValueError(f"found {written(found)}, expected the name of a road, or a mapping with its type")
    kind = found.get("type")
    if not isinstance(kind, str) or kind not in ROADS:
        expected = ", ".join(f"'{each}'" for each in ROADS)
        raise ValueError(f"found the type {written(kind)} of a road, expected one of {expected}")
    return kind_of_road(kind).model_validate(found, context=dict(context or {}))


class _RoadField:
    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        def read(found: object, info: ValidationInfo) -> Road:
            return read_road(found, info.context)

        return core_schema.with_info_plain_validator_function(read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        name = {"type": "string", "description": "the name of a road of the scene"}
        ways = [
            handler(core_schema.definitions_schema(road.__pydantic_core_schema__, []))
            for road in map(kind_of_road, ROADS)
        ]
        return {"anyOf": [name, *ways]}


AnyRoad = Annotated[Road, _RoadField()]


def read_roads(found: Any, context: Mapping[str, Any]) -> dict[str, Road]:
    """Read the roads of a scene, which its tyres use by name.

    Raises
    ------
    InputError
        If a name is not an identifier, or a road cannot be read.
    """
    if found is None:
        return {}
    if not isinstance(found, dict):
        raise InputError(f"roads: found {written(found)}, expected a mapping of names to roads")
    roads: dict[str, Road] = {}
    for name, road in found.items():
        if not isinstance(name, str) or not re.match(NAME_PATTERN, name):
            raise InputError(f"roads: found the name {written(name)}, expected letters, digits and _")
        try:
            roads[name] = read_road(road, context)
        except PydanticError as error:
            raise InputError(f"roads.{name}.{sentence(error)}") from None
        except ValueError as error:
            raise InputError(f"roads.{name}: {error}") from None
    return roads
