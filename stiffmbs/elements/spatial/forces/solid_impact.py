"""Contact of two convex solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Matrix, Symbolic, sp
from ..impact import Impact, Touch
from ..marker import Marker
from ..wrench import along_axes, seen_from

Sizes = tuple[si.PositiveLength, si.PositiveLength, si.PositiveLength]
Shape = Literal["ellipsoid", "box", "cylinder"]
ROUNDING = 1e-4
"""Edge radius of boxes and cylinders relative to half their smallest size."""


@dataclass(frozen=True)
class RoundSolid:
    """Solid about its centre, in its axes, as a Minkowski sum of ellipsoids: smooth and strictly convex.

    The support function of the sum of concentric ellipsoids with matrices M is h(n) = sum sqrt(n^T M n). Its gradient
    h'(n) is the surface point with the normal n. A box is the sum of three thin ellipsoids along its axes. A cylinder
    is that of a thin one along its axis and a flat one normal to it. Schneider, Convex Bodies: The Brunn-Minkowski
    Theory (2014), sec. 1.7 and 3.5. `ellipsoids`: squares of their semi-axes, m^2. `least`: half the smallest size, m.
    """

    ellipsoids: list[list[Expr]]
    least: Expr

    def support(self, n: Matrix) -> Expr:
        """Return the support function for a unit vector along its axes."""
        return sum(_reach(squares, n) for squares in self.ellipsoids)

    def point(self, e: Symbolic, n: Matrix) -> Matrix:
        """Return the surface point with the normal n, from its centre, along its axes."""
        reaches = [e.named(_reach(squares, n)) for squares in self.ellipsoids]
        parts = zip(self.ellipsoids, reaches, strict=True)
        by_part = [
            [square * cosine / reach for square, cosine in zip(squares, n, strict=True)] for squares, reach in parts
        ]
        return sp.Matrix([sum(along) for along in zip(*by_part, strict=True)])


def round_solid(e: Symbolic, shape: Shape, size: Expr) -> RoundSolid:
    """Return a solid with the given full sizes along its axes; the axis of a cylinder is z."""
    halves = [e.named(whole / 2) for whole in size]
    least = e.named(sp.Min(*halves))
    if shape == "ellipsoid":
        return RoundSolid([[half**2 for half in halves]], least)
    edge = e.named(ROUNDING * least)
    x, y, z = halves
    if shape == "cylinder":
        across = [e.named((half - edge) ** 2) for half in (x, y)]
        return RoundSolid([[*across, edge**2], [edge**2, edge**2, e.named((z - edge) ** 2)]], least)
    along = [e.named((half - 2 * edge) ** 2) for half in halves]
    return RoundSolid([[along[k] if k == row else edge**2 for k in range(3)] for row in range(3)], least)


def _reach(squares: list[Expr], n: Matrix) -> Expr:
    return sp.sqrt(sum(square * cosine**2 for square, cosine in zip(squares, n, strict=True)))


class SolidImpact(Impact):
    """Contact of two ellipsoids, boxes or cylinders at one point.

    The unit normal n maximises the distance n.d - h_i - h_j. Here d is the vector from the centre of j to that of i,
    and h the support function of each solid along n. The maximum is the distance of the solids, or minus the smallest
    displacement that separates them. The force acts midway between the points of both surfaces with that normal.

    Edges are rounded by 1e-4 of half the smallest size, and faces are convex by the same amount, exact at their
    centres. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N. The run
    stops where the penetration exceeds a quarter of the smallest size of either solid.
    """

    kind = "solid_impact"
    beyond = "found solids that overlap by a quarter of the smallest size of one of them, expected less: use a larger stiffness or a lower speed"
    forms = tuple({"i_shape": "box", "j_shape": "box", **form} for form in Impact.forms)

    i: Marker = Field(description="the middle of the first solid, with its axes")
    j: Marker = Field(description="the middle of the second solid, with its axes")
    i_shape: Shape = Field(description="shape of the first solid; the axis of a cylinder is z")
    i_size: Sizes = Field(description="sizes of the first solid along its axes, m")
    j_shape: Shape = Field(description="shape of the second solid")
    j_size: Sizes = Field(description="sizes of the second solid along its axes, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact along the common normal of two round solids."""
        first, second = round_solid(e, e.i_shape, e.i_size), round_solid(e, e.j_shape, e.j_size)
        offset = e.named(seen_from(e.i.point, e.j))
        axes = e.named([own.dot(other) for own in e.j.axes for other in e.i.axes])
        n = e.common_normal(offset, axes, first.ellipsoids, second.ellipsoids)

        def distance(n: Matrix) -> Expr:
            turned = [sum(n[row] * axes[3 * row + column] for row in range(3)) for column in range(3)]
            along = sum(part * own for part, own in zip(offset, n, strict=True))
            return along - first.support(turned) - second.support(n)

        gap = e.at_extremum(distance, n)
        local = e.named(second.point(e, n) + n * gap / 2)
        return [Touch(gap, e.j.point + along_axes(local, e.j.axes), e.named(along_axes(n, e.j.axes)))]

    @classmethod
    def limits(cls, e: Symbolic) -> Sequence[Expr]:
        """Return an expression that is positive up to a penetration of a quarter of the smallest size."""
        least = sp.Min(
            *(round_solid(e, shape, size).least for shape, size in ((e.i_shape, e.i_size), (e.j_shape, e.j_size)))
        )
        (touch,) = cls.touches(e)
        return (touch.gap + least / 2,)
