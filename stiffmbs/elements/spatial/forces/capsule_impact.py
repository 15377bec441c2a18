"""Contact of two capsules."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Matrix, Symbolic, sp
from ..impact import Impact, Touch
from ..marker import Marker
from .sphere_impact import length

PARALLEL = 1e-4
"""Sine of the angle between axes below which the contact point moves from an end to the middle of the overlap."""


class CapsuleImpact(Impact):
    """Contact of two capsules at the points of their axes that are nearest to each other.

    A capsule is a cylinder with half a sphere at each end; one of length 0 is a sphere. Parallel capsules touch at one
    point. The run stops when the axes meet. The force law is that of `Impact`: N = max(0, k (-g)^e - c g' step(g, -d, 1,
    0, 0)), and mu(v) N.

    Ericson, Real-Time Collision Detection (2005), sec. 5.1.9.
    """

    kind = "capsule_impact"
    beyond = "found the axes of two capsules that meet, expected them apart: use a larger stiffness or a lower speed"

    i: Marker = Field(description="the middle of the first capsule, its z along the axis")
    j: Marker = Field(description="the middle of the second capsule, its z along the axis")
    radius: si.PositiveLength = Field(description="radius of the first capsule, m")
    length: si.LengthOrZero = Field(0.0, description="length of the first capsule without its ends, m; 0 for a sphere")
    other_radius: si.PositiveLength = Field(description="radius of the second capsule, m")
    other_length: si.LengthOrZero = Field(0.0, description="length of the second capsule without its ends, m")

    @classmethod
    def nearest(cls, e: Symbolic) -> tuple[Matrix, Matrix]:
        """Return the nearest point of the first axis, and the vector to it from that of the second one."""
        apart = e.named(e.i.point - e.j.point)
        lean, first, second = (e.named(x) for x in (e.i.z.dot(e.j.z), e.i.z.dot(apart), e.j.z.dot(apart)))
        # The nearest points of the lines, then of each segment to the other's point; a second pass is exact.
        along = _within(e, (lean * second - first) / (1 - lean**2 + PARALLEL**2), e.length)
        other = _within(e, lean * along + second, e.other_length)
        along = _within(e, lean * other - first, e.length)
        return e.i.point + along * e.i.z, e.named(apart + along * e.i.z - other * e.j.z)

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact along the line between the nearest points."""
        point, offset = cls.nearest(e)
        distance = e.named(length(*offset))
        normal = e.named(offset / distance)
        return [Touch(distance - e.radius - e.other_radius, point - e.radius * normal, normal)]

    @classmethod
    def limits(cls, e: Symbolic) -> Sequence[Expr]:
        """Return the distance of the axes, less a thousandth of the radius."""
        return (length(*cls.nearest(e)[1]) - e.radius / 1000,)


def _within(e: Symbolic, x: Expr, whole: Expr) -> Expr:
    """Return a coordinate along an axis of a given length, clamped to it."""
    return e.named(sp.Min(sp.Max(x, -whole / 2), whole / 2))
