"""Markers of the plane in space: the ground's z is the normal of the plane, which no marker leaves."""

from __future__ import annotations

import math
from typing import Any

Written = dict[str, Any]
"""A part of a scene as its file writes it."""


def turned(angle: float) -> Written:
    """The orientation of what is turned about the normal, rad; none for no turn."""
    return {"orientation": {"euler": "zxz", "angles": [angle, 0, 0]}} if angle else {}


def along(angle: float) -> Written:
    """The orientation whose z, the axis of spatial joints, is the direction of a planar marker; its y is the normal."""
    return {"orientation": {"z": [math.cos(angle), math.sin(angle), 0], "y": [0, 0, 1]}}


def across(angle: float) -> Written:
    """The orientation whose z is a planar marker's normal, and whose x is its direction."""
    return {"orientation": {"z": [-math.sin(angle), math.cos(angle), 0], "x": [math.cos(angle), math.sin(angle), 0]}}


def placement(placed: Any) -> Written:
    """A named marker of a body or of ground."""
    return {**point(placed.point), **turned(placed.angle)}


def point(place: tuple[float, float]) -> Written:
    """A point of a body's own axes; none for their origin."""
    return {"point": [*place, 0]} if any(place) else {}
