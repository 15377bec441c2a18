"""Planar angles in space, where sine and cosine define an initial angle up to full turns.

Near half a turn rounding determines the sign of an initial angle. Initial angles beyond a quarter turn are therefore
measured from an added marker without the initial angle, which is then added.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

from ...reading.marker import GROUND, MarkerReference
from ..model import PlanarData

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


QUARTER = math.pi / 2
TURN = 2 * math.pi


@dataclass(frozen=True)
class Angles:
    """Angles of a planar model, and the markers added to measure them.

    Attributes
    ----------
    added : mapping of str to mapping of str to Written
        Added markers by name, by body.
    """

    data: PlanarData
    added: dict[str, dict[str, Written]] = field(default_factory=dict)

    def initial(self, i: MarkerReference, j: MarkerReference) -> float:
        """Return the angle of one marker relative to another in the described poses, rad."""
        return self.data.initial_marker(i).angle - self.data.initial_marker(j).angle

    def measured(self, i: MarkerReference, j: MarkerReference) -> str:
        """Return a formula for the angle of a named marker relative to another one."""
        initial = self.initial(i, j)
        if abs(initial) <= QUARTER:
            return f"az({i.label}, {j.label})"
        return f"(az({i.body}.{self._untwisted(i, initial)}, {j.label}) + {initial!r})"

    def _untwisted(self, i: MarkerReference, initial: float) -> str:
        """Return the name of a marker at marker i without its initial angle."""
        placed = self.data.place(i)
        marker = {**point(placed.point), **turned(placed.angle - initial)}
        own = self.data.markers if i.body == GROUND else self.data.bodies[i.body].markers
        added = self.added.setdefault(i.body, {})
        for name in map("drawn{}".format, itertools.count(1)):
            if name not in own and added.setdefault(name, marker) == marker:
                return name
        raise AssertionError
