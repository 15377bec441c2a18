"""Contact of two spheres."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic
from ..impact import Touch
from ..marker import Marker
from ..sphere_impact import SphereImpact
from ..wrench import seen_from


class SphereSphereImpact(SphereImpact):
    """Contact of a sphere about marker i with a sphere about marker j.

    The run stops when the centres coincide.
    The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "sphere_sphere_impact"

    j: Marker = Field(description="the other sphere's centre")
    other_radius: si.PositiveLength = Field(description="of the sphere about j, m")

    @classmethod
    def way(cls, e: Symbolic) -> Any:
        """Return the vector from the centre of j to that of i, along the axes of j."""
        return e.named(seen_from(e.i.point, e.j))

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact, with the gap reduced by the radius of the sphere about j."""
        (touch,) = super().touches(e)
        return [Touch(touch.gap - e.other_radius, touch.point, touch.normal)]
