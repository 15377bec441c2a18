"""Contacts of solids with a plane."""

from __future__ import annotations

from itertools import product

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic, sp
from ..impact import Impact, Touch
from ..marker import Marker

UPRIGHT = 1e-6
"""Sine of the angle between axis and normal below which the contact point moves from an end's rim to its centre."""


class PlaneImpact(Impact):
    """Base of contacts of a solid with the plane of x and y of marker j; scenes use its subclasses."""

    j: Marker = Field(description="on the plane, its z pointing out of the solid")


class BoxPlaneImpact(PlaneImpact):
    """Contact of the eight corners of a solid box with a plane.

    The force law is that of `Impact` at each corner: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "box_plane_impact"

    i: Marker = Field(description="the middle of the box, with its axes")
    x: si.PositiveLength = Field(description="size along x of i, m")
    y: si.PositiveLength = Field(description="size along y of i, m")
    z: si.PositiveLength = Field(description="size along z of i, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at each corner."""
        halves = [e.named(size * axis / 2) for size, axis in ((e.x, e.i.x), (e.y, e.i.y), (e.z, e.i.z))]
        middle, n = e.i.point - e.j.point, e.j.z
        found = []
        for signs in product((1, -1), repeat=3):
            arm = signs[0] * halves[0] + signs[1] * halves[1] + signs[2] * halves[2]
            found.append(Touch((middle + arm).dot(n), e.i.point + arm, n))
        return found


class EllipsoidPlaneImpact(PlaneImpact):
    """Contact of a solid ellipsoid with a plane at its lowest point.

    The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "ellipsoid_plane_impact"

    i: Marker = Field(description="the middle of the ellipsoid, with its axes")
    x: si.PositiveLength = Field(description="semi-axis along x of i, m")
    y: si.PositiveLength = Field(description="semi-axis along y of i, m")
    z: si.PositiveLength = Field(description="semi-axis along z of i, m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at the lowest point, where the surface normal is that of the plane.

        With the semi-axes as the columns of A, it is A A^T n / |A^T n| below the centre. The centre's distance from the
        plane at contact is |A^T n|.
        """
        n = e.j.z
        heights = [e.named(half * axis.dot(n)) for half, axis in ((e.x, e.i.x), (e.y, e.i.y), (e.z, e.i.z))]
        height = e.named(sp.sqrt(sum(part**2 for part in heights)))
        up = e.named((e.x * heights[0] * e.i.x + e.y * heights[1] * e.i.y + e.z * heights[2] * e.i.z) / height)
        return [Touch((e.i.point - e.j.point).dot(n) - height, e.i.point - up, n)]


class CylinderPlaneImpact(PlaneImpact):
    """Contact of a solid cylinder with a plane at the lowest point of the rim of each end.

    A lying cylinder touches with both ends, an upright one with the centre of the lower end. The force law is that of
    `Impact` at each of the two points: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "cylinder_plane_impact"

    i: Marker = Field(description="the middle of the cylinder, its z along the axis")
    radius: si.PositiveLength = Field(description="m")
    length: si.PositiveLength = Field(description="m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at the lowest point of each end's rim."""
        n, axis = e.j.z, e.i.z
        lean = e.named(axis.dot(n))
        across = e.named(sp.sqrt(1 - lean**2 + UPRIGHT**2))
        middle = e.named((e.i.point - e.j.point).dot(n) - e.radius * across)
        down = e.named(e.radius * (n - lean * axis) / across)
        return [
            Touch(middle + half * lean, e.i.point + half * axis - down, n) for half in (e.length / 2, -e.length / 2)
        ]
