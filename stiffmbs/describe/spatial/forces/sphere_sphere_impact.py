"""Contact of two spheres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...units import si
from ..impact import Impact, Touch, seen_from
from ..marker import Marker
from ..outside import INSIDE, length, touch_of_sphere


class SphereSphereImpact(Impact):
    """A sphere about marker i that presses on a sphere about marker j.

    The run stops where the centres come together.
    The law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind: ClassVar[str] = "sphere_sphere_impact"
    beyond: ClassVar[str] = INSIDE
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"radius": 0.1, "other_radius": 0.2},
        {"radius": 0.1, "other_radius": 0.2, "friction": 0.2, "static_friction": 0.3},
    )

    i: Marker = Field(description="the sphere's centre")
    j: Marker = Field(description="the other sphere's centre")
    radius: si.PositiveLength = Field(description="of the sphere about i, m")
    other_radius: si.PositiveLength = Field(description="of the sphere about j, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        touch = touch_of_sphere(e, e.named(seen_from(e.i.point, e.j)))
        return [Touch(touch.gap - e.other_radius, touch.point, touch.normal)]

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        return (length(*seen_from(e.i.point, e.j)) - e.radius / 1000,)
