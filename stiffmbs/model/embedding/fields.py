"""Fields of planar elements in the form of spatial scenes."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from ...elements.element import Element
from ...elements.states.amount import Amount
from ...elements.states.linear_system import PID
from ...reading.fields import Described
from ...reading.formula.formula import Formula
from ...reading.joint_name import JointName
from ...reading.marker import Marker
from ...reading.units.units import in_text
from .formulas import Angles, Written, formula, point, turned


def same(element: Element, angles: Angles, **others: Any) -> Written:
    """Return the spatial element of the same kind, with fields of the same meaning.

    Parameters
    ----------
    element : Element
        Planar element.
    angles : Angles
        Angles of its model.
    **others
        Fields with other values; None for omitted ones.
    """
    written: Written = {"type": element.kind}
    for name, field in type(element).model_fields.items():
        value = getattr(element, name)
        if name != "type" and name not in others and value != field.default:
            written[field.alias or name] = plain(value, angles)
    return written | {name: value for name, value in others.items() if value is not None}


def plain(value: Any, angles: Angles) -> Any:
    """Return a field's value as written."""
    match value:
        case Marker():
            return marker(value)
        case Formula():
            return formula(value, angles)
        case JointName():
            return str(value)
        case Amount():
            return in_text(value.written())
        case BaseModel():
            return plain(value.model_dump(exclude_defaults=True), angles)
        case dict():
            return {name: plain(part, angles) for name, part in value.items()}
        case tuple():
            return [plain(part, angles) for part in value]
    return value


def fields(described: Described, angles: Angles) -> Written:
    """Return the fields that differ from their defaults, as written."""
    found = {name: plain(value, angles) for name, value in described.__repr_args__()}
    return {"pid": found} if isinstance(described, PID) else found


def marker(found: Marker) -> str | Written:
    """Return a marker whose x and y are the axis and normal of its planar counterpart."""
    if found.marker is not None or not (any(found.point) or found.angle):
        return found.label
    return {"body": found.body, **point(found.point), **turned(found.angle)}


def oriented(found: Marker, angles: Angles, orientation: Any) -> Written:
    """Return a marker with an orientation that is a function of its planar angle."""
    placed = angles.data.place(found)
    return {"body": found.body, **point(placed.point), **orientation(placed.angle)}
