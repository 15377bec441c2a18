"""Map the values in a scene's content by the declared types of its fields."""

from __future__ import annotations

import types
import typing
from collections.abc import Iterator
from typing import Any

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.elements.roads.field import kind_of_road
from stiffmbs.elements.roads.road import Road
from stiffmbs.elements.spatial.body import Body as SpatialBody
from stiffmbs.elements.spatial.orientation import OrientationField
from stiffmbs.elements.spatial.spatial_kinds import FORCES as SPATIAL_FORCES
from stiffmbs.elements.spatial.spatial_kinds import JOINTS as SPATIAL_JOINTS
from stiffmbs.reading.fields import Measured
from stiffmbs.reading.formula.field import FormulaOf
from stiffmbs.reading.marker import MarkerReference

from ..random_scenes.draft import Content

OPAQUE = ("properties", "function")
"""Fields with numbers whose units are not declared."""


class NotLegitimate(Exception):
    """The transformation would change the motion of the scene."""


class Mapper:
    """Mapping of each value of a scene; the default is the identity."""

    def number(self, value: Any, measured: Measured, owner: Content) -> Any:
        """Map a number with a unit."""
        return value

    def formula(self, value: Any, kind: FormulaOf, owner: Content) -> Any:
        """Map a formula, a number or a table."""
        return value

    def marker(self, value: Any) -> Any:
        """Map a marker."""
        return value

    def orientation(self, value: Any) -> Any:
        """Map an orientation of a body."""
        return value

    def opaque(self, name: str, value: Any) -> Any:
        """Map a value with undeclared numbers."""
        return value


def class_of(section: str, entry: Content, dimensions: int) -> type[Any]:
    """Return the class of an entry of a scene's section."""
    match section:
        case "bodies":
            return SpatialBody if dimensions == 3 else Body
        case "roads":
            return kind_of_road(entry["type"])
        case "joints":
            return (SPATIAL_JOINTS if dimensions == 3 else JOINTS)[entry["type"]]
        case _:
            return (SPATIAL_FORCES if dimensions == 3 else FORCES)[entry["type"]]


def mapped(entry: Content, described: type[Any], mapper: Mapper, defaults: bool = False) -> Content:
    """Return an entry with mapped values.

    Parameters
    ----------
    entry : dict
        Entry of a scene.
    described : type
        Class of the entry.
    mapper : Mapper
    defaults : bool
        True to write fields with a numeric default as well.
    """
    described.model_rebuild()
    found = dict(entry)
    for name, field in described.model_fields.items():
        key = field.alias or name
        if key in OPAQUE and key in entry:
            found[key] = mapper.opaque(key, entry[key])
        elif key in entry:
            found[key] = _mapped(entry[key], field.annotation, field.metadata, mapper, entry)
        elif defaults and isinstance(field.default, float) and field.default and _measured(field.metadata):
            found[key] = _mapped(field.default, field.annotation, field.metadata, mapper, entry)
    return found


def _mapped(value: Any, annotation: Any, metadata: Any, mapper: Mapper, owner: Content) -> Any:
    """Return the mapped value of a field, by its type."""
    for kind in metadata:
        match kind:
            case Measured():
                return mapper.number(value, kind, owner)
            case FormulaOf():
                return mapper.formula(value, kind, owner)
            case OrientationField():
                return mapper.orientation(value)
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _mapped(value, arguments[0], annotation.__metadata__, mapper, owner)
    if origin in (types.UnionType, typing.Union):
        return value if value is None else _mapped(value, _chosen(arguments, value), (), mapper, owner)
    if origin is tuple and isinstance(value, list):
        return list(_items(value, arguments, mapper, owner))
    if origin is tuple and len(arguments) == 2 and arguments[1] is Ellipsis:
        return _mapped(value, arguments[0], (), mapper, owner)
    if isinstance(annotation, type) and issubclass(annotation, MarkerReference):
        return mapper.marker(value)
    return value


def _chosen(arguments: tuple[Any, ...], value: Any) -> Any:
    """Return the member of a union that matches a value."""
    present = [kind for kind in arguments if kind is not type(None)]
    lists = [kind for kind in present if typing.get_origin(kind) is tuple]
    return lists[0] if lists and isinstance(value, list) else present[0]


def _items(value: list[Any], arguments: tuple[Any, ...], mapper: Mapper, owner: Content) -> Iterator[Any]:
    """Yield the items of a list; a diagonal represents a matrix."""
    if len(arguments) == 2 and arguments[1] is Ellipsis:
        arguments = (arguments[0],) * len(value)
    for k, (item, kind) in enumerate(zip(value, arguments, strict=True)):
        rows = typing.get_args(kind) if typing.get_origin(kind) is tuple else ()
        yield _mapped(item, rows[k] if rows and not isinstance(item, list) else kind, (), mapper, owner)


def _measured(metadata: Any) -> bool:
    return any(isinstance(kind, Measured) for kind in metadata)


def mapped_scene(content: Content, mapper: Mapper, defaults: bool = False) -> Content:
    """Return a scene with mapped values in its bodies, joints, forces and roads."""
    dimensions = content.get("dimensions", 2)
    found = dict(content)
    for section in ("bodies", "joints", "forces", "roads"):
        entries = content.get(section, {})
        if entries:
            found[section] = {
                name: mapped(entry, class_of(section, entry, dimensions), mapper, defaults)
                for name, entry in entries.items()
            }
    return found


def has_road(described: type[Any]) -> bool:
    """Return True for an element on a road, which is fixed to the ground unless a marker carries it."""
    field = described.model_fields.get("road")
    return field is not None and isinstance(field.annotation, type) and issubclass(field.annotation, Road)
