"""Planar markers in space: the ground's z is the normal of the plane."""

from __future__ import annotations

import math
from typing import Any

Written = dict[str, Any]
"""Part of a scene as in its file."""


def turned(angle: float) -> Written:
    """Return the orientation of a rotation about the normal, rad; empty for zero."""
    return {"orientation": {"euler": "zxz", "angles": [angle, 0, 0]}} if angle else {}


def along(angle: float) -> Written:
    """Return the orientation with z, the axis of spatial joints, along a planar marker; its y is the normal."""
    return {"orientation": {"z": [math.cos(angle), math.sin(angle), 0], "y": [0, 0, 1]}}


def across(angle: float) -> Written:
    """Return the orientation with z along a planar marker's normal, and x along its direction."""
    return {"orientation": {"z": [-math.sin(angle), math.cos(angle), 0], "x": [math.cos(angle), math.sin(angle), 0]}}


def placement(placed: Any) -> Written:
    """Return a named marker of a body or of ground."""
    return {**point(placed.point), **turned(placed.angle)}


def point(place: tuple[float, float]) -> Written:
    """Return a point in a body's axes; empty for the origin."""
    return {"point": [*place, 0]} if any(place) else {}
