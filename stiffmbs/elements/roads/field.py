"""Roads as fields of elements, by name or by value, and the section of a scene that names them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING

from ...reading.did_you_mean import instead_of
from ...reading.fields import located, named_entries
from ...reading.files.quoted import quoted
from ..read_by import Context, JsonSchema, ReadBy, class_of

if TYPE_CHECKING:
    from .road import Road

ROADS: Mapping[str, str] = {
    "flat": "road:FlatRoad",
    "formula": "formula:FormulaRoad",
    "table": "profile:TableRoad",
    "grid": "grid:GridRoad",
    "crg": "crg:CrgRoad",
    "step": "obstacles:StepRoad",
    "cosine_bump": "obstacles:CosineBump",
    "sine_sweep": "obstacles:SineSweep",
    "iso8608": "iso8608:Iso8608Road",
}
"""File and class of each kind of road, imported on demand."""


def kind_of_road(kind: str) -> type[Road]:
    """Return the class of a kind of road."""
    return _imported(ROADS[kind])


def _imported(place: str) -> type[Road]:
    file, _, name = place.partition(":")
    road: type[Road] = getattr(import_module(f".{file}", __package__), name)
    return road


def read_road(found: object, context: Context) -> Road:
    """Return the road of a field."""
    from .road import Road

    if isinstance(found, Road):
        return found
    if isinstance(found, str):
        known = (context or {}).get("roads") or {}
        if found not in known:
            raise ValueError(f"found the unknown road '{quoted(found)}'{instead_of(found, known)}")
        return known[found]  # type: ignore[no-any-return]
    file = class_of(found, ROADS, "the name of a road, or a mapping with its type")
    return _imported(file).model_validate(found, context=dict(context or {}))


def _schema(schema_of: Callable[[type[Road]], JsonSchema]) -> JsonSchema:
    name = {"type": "string", "description": "the name of a road of the scene"}
    return {"anyOf": [name, *(schema_of(kind_of_road(kind)) for kind in ROADS)]}


ROAD = ReadBy(read_road, _schema)
"""Marker of a field with a road: ``Annotated[Road, ROAD]``."""


def read_roads(found: object, context: Mapping[str, object]) -> dict[str, Road]:
    """Read the roads of a scene, which its tyres use by name.

    Raises InputError if a name is not an identifier, or a road cannot be read.
    """
    roads: dict[str, Road] = {}
    for name, road in named_entries("roads", found, "roads"):
        with located(f"roads.{name}"):
            roads[name] = read_road(road, context)
    return roads
