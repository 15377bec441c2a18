"""Contact of an ellipsoid with a plane."""

from __future__ import annotations

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic
from ..impact import Impact, Touch
from ..marker import Marker


class EllipsoidPlaneImpact(Impact):
    """Contact of a solid ellipsoid with a plane at its lowest point.

    The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "ellipsoid_plane_impact"

    i: Marker = Field(description="the middle of the ellipsoid, with its axes")
    j: Marker = Field(description="on the plane, its z pointing out of the solid")
    x: si.PositiveLength = Field(description="semi-axis along x of i, m")
    y: si.PositiveLength = Field(description="along y, m")
    z: si.PositiveLength = Field(description="along z, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at the lowest point, where the surface normal is that of the plane.

        With the semi-axes as the columns of A, it is A A^T n / |A^T n| below the centre. The centre's distance from the
        plane at contact is |A^T n|.
        """
        from sympy import sqrt

        n = e.j.z
        ways = [e.named(half * axis.dot(n)) for half, axis in ((e.x, e.i.x), (e.y, e.i.y), (e.z, e.i.z))]
        height = e.named(sqrt(sum(way**2 for way in ways)))
        up = e.named((e.x * ways[0] * e.i.x + e.y * ways[1] * e.i.y + e.z * ways[2] * e.i.z) / height)
        return [Touch((e.i.point - e.j.point).dot(n) - height, e.i.point - up, n)]
