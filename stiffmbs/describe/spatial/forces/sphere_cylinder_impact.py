"""Contact of a sphere with a cylinder."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...units import si
from ..impact import Impact, Touch, seen_from
from ..marker import Marker
from ..outside import INSIDE, above, length, touch_of_sphere


class SphereCylinderImpact(Impact):
    """A sphere about marker i that presses on the mantle, an end or an edge of a solid cylinder.

    The point of contact is the one of the cylinder nearest to the sphere's centre.  The run stops where the centre enters the
    cylinder.  The law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind: ClassVar[str] = "sphere_cylinder_impact"
    beyond: ClassVar[str] = INSIDE
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"radius": 0.1},
        {"radius": 0.1, "friction": 0.2, "static_friction": 0.3},
    )

    i: Marker = Field(description="the sphere's centre")
    j: Marker = Field(description="the middle of the cylinder, its z along the axis")
    radius: si.PositiveLength = Field(description="of the sphere, m")
    cylinder_radius: si.PositiveLength = Field(description="m")
    cylinder_length: si.PositiveLength = Field(description="m")

    @classmethod
    def way(cls, e: Symbolic) -> Any:
        """From the nearest point of the cylinder to the sphere's centre, along the axes of j."""
        from sympy import sign

        x, y, z = e.named(seen_from(e.i.point, e.j))
        out = e.named(length(x, y))
        across = e.named(above(out - e.cylinder_radius) / out)
        return e.named([across * x, across * y, sign(z) * above(abs(z) - e.cylinder_length / 2)])

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        return [touch_of_sphere(e, cls.way(e))]

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        return (length(*cls.way(e)) - e.radius / 1000,)
