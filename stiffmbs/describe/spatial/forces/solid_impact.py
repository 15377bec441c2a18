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
    """Contact of two ellipsoids, boxes or cylinders at one point.

    The unit normal n maximises the distance n.d - h_i - h_j. Here d is the vector from the centre of j to that of i,
    and h the support function of each solid along n. The maximum is the distance of the solids, or minus the smallest
    displacement that separates them. The force acts midway between the points of both surfaces with that normal.

    Edges are rounded by 1e-4 of half the smallest size, and faces are convex by the same amount, exact at their
    centres. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N. The run
    stops where the penetration exceeds a quarter of the smallest size of either solid.
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
        """Return the single contact."""
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
        """Return an expression that is positive up to a penetration of a quarter of the smallest size."""
        from sympy import Min

        least = Min(
            *(round_solid(e, shape, size).least for shape, size in ((e.i_shape, e.i_size), (e.j_shape, e.j_size)))
        )
        (touch,) = cls.touches(e)
        return (touch.gap + least / 2,)


def _in_ground(e: Symbolic, v: Any) -> Any:
    return v[0] * e.j.x + v[1] * e.j.y + v[2] * e.j.z
