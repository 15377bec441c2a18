"""Contact of a sphere with a box."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic
from ..marker import Marker
from ..sphere_impact import SphereImpact, above
from ..wrench import seen_from


class SphereBoxImpact(SphereImpact):
    """Contact of a sphere about marker i with a face, an edge or a corner of a solid box.

    The contact point is the point of the box nearest to the sphere's centre. The run stops when the centre enters the
    box. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "sphere_box_impact"

    j: Marker = Field(description="the middle of the box, with its axes")
    x: si.PositiveLength = Field(description="size of the box along x of j, m")
    y: si.PositiveLength = Field(description="along y, m")
    z: si.PositiveLength = Field(description="along z, m")

    @classmethod
    def way(cls, e: Symbolic) -> Any:
        """Return the vector from the nearest point of the box to the sphere's centre, along the axes of j."""
        from sympy import sign

        at = e.named(seen_from(e.i.point, e.j))
        return e.named(
            [sign(part) * above(abs(part) - size / 2) for part, size in zip(at, (e.x, e.y, e.z), strict=True)]
        )
