"""Contact of a sphere with a cylinder."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic
from ..marker import Marker
from ..sphere_impact import SphereImpact, above, length
from ..wrench import seen_from


class SphereCylinderImpact(SphereImpact):
    """Contact of a sphere about marker i with the lateral surface, an end or an edge of a solid cylinder.

    The contact point is the point of the cylinder nearest to the sphere's centre. The run stops when the centre enters
    the cylinder. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "sphere_cylinder_impact"

    j: Marker = Field(description="the middle of the cylinder, its z along the axis")
    cylinder_radius: si.PositiveLength = Field(description="m")
    cylinder_length: si.PositiveLength = Field(description="m")

    @classmethod
    def way(cls, e: Symbolic) -> Any:
        """Return the vector from the nearest point of the cylinder to the sphere's centre, along the axes of j."""
        from sympy import sign

        x, y, z = e.named(seen_from(e.i.point, e.j))
        out = e.named(length(x, y))
        across = e.named(above(out - e.cylinder_radius) / out)
        return e.named([across * x, across * y, sign(z) * above(abs(z) - e.cylinder_length / 2)])
