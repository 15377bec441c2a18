"""Fields of planar elements in the form of spatial scenes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from ...elements.element import Element
from ...reading.marker import Marker, MarkerReference
from ..model_text import written
from .formulas import Angles, Written, formula, placement, point


def same(element: Element, angles: Angles, **others: object) -> Written:
    """Return the spatial element of the same kind as a planar one, with fields of the same meaning.

    `angles` are those of its model. `others` are fields with other values; None for omitted ones.
    """
    own = {name: plain(value, angles) for name, value in element.__repr_args__() if name not in others}
    return {"type": element.kind, **own, **{name: value for name, value in others.items() if value is not None}}


def plain(value: object, angles: Angles) -> Any:
    """Return a value as written in a spatial scene."""
    return written(value, marker, partial(formula, angles=angles))


def marker(found: MarkerReference) -> str | Written:
    """Return a marker whose x and y are the axis and normal of its planar counterpart."""
    placed = None if found.marker else found.placement()
    at = {} if placed is None else placement(placed)
    return {"body": found.body, **at} if at else found.label


def oriented(found: Marker, angles: Angles, orientation: Callable[[float], Written]) -> Written:
    """Return a marker with an orientation that is a function of its planar angle."""
    placed = angles.data.place(found)
    return {"body": found.body, **point(placed.point), **orientation(placed.angle)}
