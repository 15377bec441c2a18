"""Bases of the planar joints between two markers, and their coordinates."""

from __future__ import annotations

from ...reading.marker import Marker
from ..element import Expr, Symbolic
from .pair import Pair


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
