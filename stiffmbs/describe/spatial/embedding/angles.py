"""Angles of the plane in space, where the sine and cosine of an initial angle tell it up to whole turns.

Near half a turn rounding decides whether an initial angle is above or below zero.  What is initially turned further than a
quarter is therefore measured from a marker that is not turned at first, and the initial angle is added.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

from ...marker import GROUND, MarkerReference
from ...model import PlanarData
from .markers import Written, point, turned

QUARTER = math.pi / 2
TURN = 2 * math.pi


@dataclass(frozen=True)
class Angles:
    """The angles of a planar model, and the markers that they are measured from besides the model's own.

    Attributes
    ----------
    data : PlanarData
    added : mapping of str to mapping of str to Written
        Markers by name, by body.
    """

    data: PlanarData
    added: dict[str, dict[str, Written]] = field(default_factory=dict)

    def initial(self, i: MarkerReference, j: MarkerReference) -> float:
        """The angle of one marker against another as the bodies are described, rad."""
        return self.data.initial_marker(i).angle - self.data.initial_marker(j).angle

    def measured(self, i: MarkerReference, j: MarkerReference) -> str:
        """A formula for the angle of a named marker against another one."""
        initial = self.initial(i, j)
        if abs(initial) <= QUARTER:
            return f"az({i.label}, {j.label})"
        return f"(az({i.body}.{self._untwisted(i, initial)}, {j.label}) + {initial!r})"

    def _untwisted(self, i: MarkerReference, initial: float) -> str:
        """The name of a marker that is marker i without its initial angle."""
        placed = self.data.place(i)
        marker = {**point(placed.point), **turned(placed.angle - initial)}
        own = self.data.markers if i.body == GROUND else self.data.bodies[i.body].markers
        added = self.added.setdefault(i.body, {})
        for name in map("drawn{}".format, itertools.count(1)):
            if name not in own and added.setdefault(name, marker) == marker:
                return name
        raise AssertionError
