"""Bases of the planar joints between two markers, and their coordinates."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Self

from ...reading.marker import Marker
from ..element import Expr, Symbolic
from .pair import Pair

if TYPE_CHECKING:
    from ...model.model_data import ModelData


class PlanarPair(Pair[Marker]):
    """Base of the planar joints between two markers; a subclass names its coordinates among these."""

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        """Return the angle of marker i relative to marker j."""
        return e.i.angle - e.j.angle

    @staticmethod
    def displacement(e: Symbolic) -> Expr:
        """Return the displacement of marker i along the axis of marker j."""
        return (e.i.point - e.j.point).dot(e.j.axis)


class InOneTurn(PlanarPair):
    """Base of the planar joints that constrain the angle, within the turn of the described poses."""

    def at_initial_pose(self, model: ModelData) -> Self:
        """Return the joint with the angle of marker i reduced by its full turns relative to marker j.

        An equation between both angles then holds in the described poses.
        """
        turns = round((model.initial_marker(self.i).angle - model.initial_marker(self.j).angle) / math.tau)
        if not turns:
            return self
        placed = model.place(self.i)
        i = Marker(body=self.i.body, point=placed.point, angle=placed.angle - math.tau * turns)
        return self.model_copy(update={"i": i})
