"""Contacts of a sphere with a sphere, a box and a cylinder."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Symbolic, sp
from ...loads import length as of_vector
from ..impact import Impact, Touch
from ..marker import Marker
from ..wrench import along_axes, seen_from

LEAST_DISTANCE = 1e-9
"""Offset of distances in quadrature, m, for finite derivatives at zero."""


def above(x: Expr) -> Expr:
    """Return max(x, 0)."""
    return sp.Max(x, 0)


def length(*parts: Expr) -> Expr:
    """Return the length of a vector, with a finite derivative at zero."""
    return of_vector(*parts, tiny=LEAST_DISTANCE**2)


class SphereImpact(Impact):
    """Base of contacts of a sphere about marker i with a solid about marker j; scenes use its subclasses.

    The contact point is the point of the solid nearest to the sphere's centre. The run stops when the centre enters the
    solid.
    """

    beyond = "found the centre of a sphere inside the other solid, expected it outside: use a larger stiffness or a lower speed"

    i: Marker = Field(description="the sphere's centre")
    radius: si.PositiveLength = Field(description="radius of the sphere, m")

    @classmethod
    def offset(cls, e: Symbolic) -> list[Expr]:
        """Return the vector from the nearest point of the solid to the sphere's centre, along the axes of j."""
        raise NotImplementedError

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at the nearest point."""
        offset = cls.offset(e)
        distance = e.named(length(*offset))
        normal = e.named(along_axes([part / distance for part in offset], e.j.axes))
        return [Touch(distance - e.radius, e.i.point - e.radius * normal, normal)]

    @classmethod
    def limits(cls, e: Symbolic) -> Sequence[Expr]:
        """Return the distance of the centre from the solid, less a thousandth of the radius."""
        return (length(*cls.offset(e)) - e.radius / 1000,)


class SphereSphereImpact(SphereImpact):
    """Contact of a sphere about marker i with a sphere about marker j.

    The run stops when the centres coincide.
    The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "sphere_sphere_impact"

    j: Marker = Field(description="the other sphere's centre")
    other_radius: si.PositiveLength = Field(description="radius of the sphere about j, m")

    @classmethod
    def offset(cls, e: Symbolic) -> list[Expr]:
        return e.named(seen_from(e.i.point, e.j))

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact, with the gap reduced by the radius of the sphere about j."""
        (touch,) = super().touches(e)
        return [Touch(touch.gap - e.other_radius, touch.point, touch.normal)]


class SphereBoxImpact(SphereImpact):
    """Contact of a sphere about marker i with a face, an edge or a corner of a solid box.

    The contact point is the point of the box nearest to the sphere's centre. The run stops when the centre enters the
    box. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "sphere_box_impact"

    j: Marker = Field(description="the middle of the box, with its axes")
    x: si.PositiveLength = Field(description="size of the box along x of j, m")
    y: si.PositiveLength = Field(description="size along y of j, m")
    z: si.PositiveLength = Field(description="size along z of j, m")

    @classmethod
    def offset(cls, e: Symbolic) -> list[Expr]:
        at = e.named(seen_from(e.i.point, e.j))
        return e.named(
            [sp.sign(part) * above(abs(part) - size / 2) for part, size in zip(at, (e.x, e.y, e.z), strict=True)]
        )


class SphereCylinderImpact(SphereImpact):
    """Contact of a sphere about marker i with the lateral surface, an end or an edge of a solid cylinder.

    The contact point is the point of the cylinder nearest to the sphere's centre. The run stops when the centre enters
    the cylinder. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "sphere_cylinder_impact"

    j: Marker = Field(description="the middle of the cylinder, its z along the axis")
    cylinder_radius: si.PositiveLength = Field(description="radius of the cylinder, m")
    cylinder_length: si.PositiveLength = Field(description="length of the cylinder, m")

    @classmethod
    def offset(cls, e: Symbolic) -> list[Expr]:
        """Return the vector from the nearest point of the cylinder to the sphere's centre, along the axes of j."""
        x, y, z = e.named(seen_from(e.i.point, e.j))
        out = e.named(length(x, y))
        across = e.named(above(out - e.cylinder_radius) / out)
        return e.named([across * x, across * y, sp.sign(z) * above(abs(z) - e.cylinder_length / 2)])
