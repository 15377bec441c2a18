"""Base of contacts of a sphere with a solid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..units import si
from .impact import Impact, Touch
from .marker import Marker
from .outside import length


class SphereImpact(Impact):
    """Base of contacts of a sphere about marker i with a solid about marker j; scenes use its subclasses.

    The contact point is the point of the solid nearest to the sphere's centre. The run stops when the centre enters the
    solid.
    """

    beyond: ClassVar[str] = (
        "found the centre of a sphere inside the solid that it meets, expected it outside: more stiffness, or a lower speed"
    )
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"radius": 0.1},
        {"radius": 0.1, "friction": 0.2, "static_friction": 0.3},
    )

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
        x, y, z = (part / distance for part in way)
        normal = e.named(x * e.j.x + y * e.j.y + z * e.j.z)
        return [Touch(distance - e.radius, e.i.point - e.radius * normal, normal)]

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        """Return the distance of the centre from the solid, less a thousandth of the radius."""
        return (length(*cls.way(e)) - e.radius / 1000,)
