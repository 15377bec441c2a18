"""Base of contacts of a sphere with a solid."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ...reading.units import si
from ..element import Symbolic
from ..forces.friction import magnitude
from .impact import Impact, Touch
from .marker import Marker
from .wrench import along_axes

LEAST_DISTANCE = 1e-9
"""Offset of distances in quadrature, m, for finite derivatives at zero."""


def above(x: Any) -> Any:
    """Return max(x, 0)."""
    from sympy import Max

    return Max(x, 0)


def length(*parts: Any) -> Any:
    """Return the length of a vector, with a finite derivative at zero."""
    return magnitude(*parts, tiny=LEAST_DISTANCE**2)


class SphereImpact(Impact):
    """Base of contacts of a sphere about marker i with a solid about marker j; scenes use its subclasses.

    The contact point is the point of the solid nearest to the sphere's centre. The run stops when the centre enters the
    solid.
    """

    beyond = "found the centre of a sphere inside the solid that it meets, expected it outside: more stiffness, or a lower speed"

    i: Marker = Field(description="the sphere's centre")
    radius: si.PositiveLength = Field(description="of the sphere, m")

    @classmethod
    def way(cls, e: Symbolic) -> Any:
        """Return the vector from the nearest point of the solid to the sphere's centre, along the axes of j."""
        raise NotImplementedError

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return the contact at the nearest point."""
        way = cls.way(e)
        distance = e.named(length(*way))
        normal = e.named(along_axes([part / distance for part in way], e.j.axes))
        return [Touch(distance - e.radius, e.i.point - e.radius * normal, normal)]

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        """Return the distance of the centre from the solid, less a thousandth of the radius."""
        return (length(*cls.way(e)) - e.radius / 1000,)
