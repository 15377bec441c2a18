"""Contact of a box with a plane."""

from __future__ import annotations

from itertools import product

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic
from ..impact import Impact, Touch
from ..marker import Marker


class BoxPlaneImpact(Impact):
    """Contact of the eight corners of a solid box with a plane.

    The force law is that of `Impact` at each corner: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "box_plane_impact"

    i: Marker = Field(description="the middle of the box, with its axes")
    j: Marker = Field(description="on the plane, its z pointing out of the solid")
    x: si.PositiveLength = Field(description="size along x of i, m")
    y: si.PositiveLength = Field(description="along y, m")
    z: si.PositiveLength = Field(description="along z, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at each corner."""
        halves = [e.named(size * axis / 2) for size, axis in ((e.x, e.i.x), (e.y, e.i.y), (e.z, e.i.z))]
        middle, n = e.i.point - e.j.point, e.j.z
        found = []
        for signs in product((1, -1), repeat=3):
            arm = signs[0] * halves[0] + signs[1] * halves[1] + signs[2] * halves[2]
            found.append(Touch((middle + arm).dot(n), e.i.point + arm, n))
        return found
