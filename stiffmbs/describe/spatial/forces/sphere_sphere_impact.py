"""Contact of two spheres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...units import si
from ..impact import Touch, seen_from
from ..marker import Marker
from ..sphere_impact import SphereImpact


class SphereSphereImpact(SphereImpact):
    """Contact of a sphere about marker i with a sphere about marker j.

    The run stops when the centres coincide.
    The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind: ClassVar[str] = "sphere_sphere_impact"
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"radius": 0.1, "other_radius": 0.2},
        {"radius": 0.1, "other_radius": 0.2, "friction": 0.2, "static_friction": 0.3},
    )

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
