"""Contact of two convex solids."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...units import si
from ..impact import Impact, Touch, seen_from
from ..marker import Marker
from ..round_solid import Shape, round_solid

Sizes = tuple[si.PositiveLength, si.PositiveLength, si.PositiveLength]


class SolidImpact(Impact):
    """Two ellipsoids, boxes or cylinders that press on each other at one point.

    The normal n of unit length makes the distance n.d - h_i - h_j largest, for d from the middle of j to that of i and the reach h
    of each solid along n: the distance of both, or minus the least way that parts them.  The force acts in the middle between the
    points of both surfaces with that normal.  Edges are rounded by 1e-4 of half the least size, and faces bulge as little; a face
    is at its place in its middle.  The law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    The run stops where the solids overlap by a quarter of the least size of the smaller one.
    """

    kind: ClassVar[str] = "solid_impact"
    beyond: ClassVar[str] = (
        "found solids that overlap by a quarter of the least size of one of them, expected less: more stiffness, or a lower speed"
    )
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"i_shape": "box", "j_shape": "box", "i_size": [0.3, 0.2, 0.1], "j_size": [1, 1, 0.2]},
        {"i_shape": "box", "j_shape": "box", "i_size": [0.3, 0.2, 0.1], "j_size": [1, 1, 0.2], "friction": 0.2, "static_friction": 0.3},
    )  # fmt: skip

    i: Marker = Field(description="the middle of the first solid, with its axes")
    j: Marker = Field(description="the middle of the second solid, with its axes")
    i_shape: Shape = Field(description="of the first solid; the axis of a cylinder is z")
    i_size: Sizes = Field(description="of the first solid along its axes, m")
    j_shape: Shape = Field(description="of the second solid")
    j_size: Sizes = Field(description="of the second solid along its axes, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """One."""
        first, second = round_solid(e, e.i_shape, e.i_size), round_solid(e, e.j_shape, e.j_size)
        way = e.named(seen_from(e.i.point, e.j))
        axes = e.named([own.dot(other) for own in e.j.axes for other in e.i.axes])
        n = e.common_normal(way, axes, first.ellipsoids, second.ellipsoids)

        def distance(n: Any) -> Any:
            turned = [sum(n[row] * axes[3 * row + column] for row in range(3)) for column in range(3)]
            along = sum(part * own for part, own in zip(way, n, strict=True))
            return along - first.support(turned) - second.support(n)

        gap = e.at_extremum(distance, n)
        local = e.named(second.point(e, n) + n * gap / 2)
        return [Touch(gap, e.j.point + _in_ground(e, local), e.named(_in_ground(e, n)))]

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        """Above zero up to a quarter of the least size."""
        from sympy import Min

        least = Min(
            *(round_solid(e, shape, size).least for shape, size in ((e.i_shape, e.i_size), (e.j_shape, e.j_size)))
        )
        (touch,) = cls.touches(e)
        return (touch.gap + least / 2,)


def _in_ground(e: Symbolic, v: Any) -> Any:
    return v[0] * e.j.x + v[1] * e.j.y + v[2] * e.j.z
