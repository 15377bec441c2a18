"""Contact of a cylinder with a plane."""

from __future__ import annotations

from pydantic import Field

from ....reading.units import si
from ...element import Symbolic
from ..impact import Impact, Touch
from ..marker import Marker

UPRIGHT = 1e-6
"""Sine of the angle between axis and normal below which the contact point moves from an end's rim to its centre."""


class CylinderPlaneImpact(Impact):
    """Contact of a solid cylinder with a plane at the lowest point of the rim of each end.

    A lying cylinder touches with both ends, an upright one with the centre of the lower end. The force law is that of
    `Impact` at each of the two points: N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)), and mu(v) N.
    """

    kind = "cylinder_plane_impact"

    i: Marker = Field(description="the middle of the cylinder, its z along the axis")
    j: Marker = Field(description="on the plane, its z pointing out of the solid")
    radius: si.PositiveLength = Field(description="m")
    length: si.PositiveLength = Field(description="m")

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at the lowest point of each end's rim."""
        from sympy import sqrt

        n, axis = e.j.z, e.i.z
        lean = e.named(axis.dot(n))
        across = e.named(sqrt(1 - lean**2 + UPRIGHT**2))
        middle = e.named((e.i.point - e.j.point).dot(n) - e.radius * across)
        down = e.named(e.radius * (n - lean * axis) / across)
        return [
            Touch(middle + half * lean, e.i.point + half * axis - down, n) for half in (e.length / 2, -e.length / 2)
        ]
