"""The table of a described class's fields: name, what it takes with its unit and bounds, default, meaning."""

from __future__ import annotations

import types
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic_core import PydanticUndefined

from stiffmbs.elements.element import Force, Joint
from stiffmbs.elements.spatial.marker import Placement as SpatialPlacement
from stiffmbs.elements.spatial.orientation import OrientationField
from stiffmbs.reading.fields import Described, Measured
from stiffmbs.reading.formula.field import FormulaOf
from stiffmbs.reading.joint_name import JointName
from stiffmbs.reading.marker import MarkerReference, Placement
from stiffmbs.reading.units.units import ANY, DIMENSIONS

WORDS = {
    MarkerReference: "marker",
    Placement: "marker",
    SpatialPlacement: "marker",
    Joint: "joint",
    Force: "force",
    JointName: "joint's name",
    str: "text",
    bool: "true or false",
    int: "whole number",
    float: "number",
}
"""By class; a class comes before its bases."""


def field_table(described: type[Described]) -> Iterator[str]:
    """Lines of reStructuredText."""
    yield from (".. list-table::", "   :header-rows: 1", "   :widths: 18 30 14 38", "")
    for row in (("field", "takes", "default", "meaning"), *_rows(described)):
        yield from (f"   {'*' if k == 0 else ' '} - {cell}" for k, cell in enumerate(row))
    yield ""


def _rows(described: type[Described]) -> Iterator[tuple[str, ...]]:
    """Required fields first."""
    for name, field in sorted(described.model_fields.items(), key=lambda item: not item[1].is_required()):
        if name == "type":
            continue
        takes = words(field.annotation, field.metadata)
        yield f"``{field.alias or name}``", takes, _default(field), field.description or ""


def _default(field: Any) -> str:
    if field.is_required():
        return "required"
    if field.default is PydanticUndefined or field.default == "":
        return "none"
    return _shown(field.default)


def _shown(default: Any) -> str:
    match default:
        case bool():
            return str(default).lower()
        case float():
            return f"{default:g}"
        case None:
            return "none"
        case tuple():
            parts = [_shown(part) for part in default]
            return f"[{', '.join(parts)}]" if set(parts) - {"none"} else "none"
        case Described():
            return f"``{{type: {default.type}}}``"
    return f"``{default}``"


def words(annotation: Any, metadata: Any = ()) -> str:
    """What a field takes, in words."""
    for mark in metadata:
        match mark:
            case Measured():
                return _measured(mark)
            case FormulaOf():
                return _formula(mark)
            case OrientationField():
                return "orientation"
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return words(parts[0], parts[1:])
    if origin is Literal:
        return " or ".join(f"``{choice}``" for choice in parts)
    if origin in (Union, types.UnionType):
        return " or ".join(dict.fromkeys(words(part) for part in parts if part is not type(None)))
    if origin is tuple:
        return _listed(parts)
    if origin is dict:
        return f"mapping of names to {words(parts[1])}"
    return _named(annotation)


def _named(annotation: type) -> str:
    for base, word in WORDS.items():
        if issubclass(annotation, base):
            return word
    return f"see {annotation.__name__}"


def _listed(parts: tuple[Any, ...]) -> str:
    """A list of any length, a list with a place for each part, or a matrix."""
    if parts[-1] is Ellipsis:
        return f"list of {words(parts[0])}"
    if all(get_origin(part) is tuple for part in parts):
        inner = [words(entry) for part in parts for entry in get_args(part)]
        return f"{len(parts)} by {len(get_args(parts[0]))}: {', '.join(dict.fromkeys(inner))}"
    return f"list of {len(parts)}: {', '.join(dict.fromkeys(words(part) for part in parts))}"


def _measured(mark: Measured) -> str:
    unit = DIMENSIONS[mark.dimension][1]
    limits = (("above", mark.above), ("at least", mark.at_least), ("at most", mark.at_most))
    bounds = [f"{word} {limit:g}" for word, limit in limits if limit is not None]
    return ", ".join([mark.dimension if unit == "1" else f"{mark.dimension} ({unit})", *bounds])


def _formula(mark: FormulaOf) -> str:
    names = [*mark.variables, *(["t"] if mark.time else [])]
    names += ["coordinates"] if mark.coordinates else []
    names += ["velocities"] if mark.velocities else []
    unit = "" if mark.dimension == ANY else f" ({DIMENSIONS[mark.dimension][1]})"
    return f"formula of {', '.join(names)}" + (" or table" if mark.table else "") + unit
