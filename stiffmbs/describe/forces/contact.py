"""Contact of a point or circle with a line or circle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field

from ..element import Symbolic
from ..marker import Marker
from ..units import si
from .contact_law import ContactLaw
from .friction import Friction


class Contact(ContactLaw):
    """Contact of a point or circle about marker i with a line or circle of marker j, with friction.

    With the penetration delta = -gap > 0 the normal force is N = k delta^n (1 + chi delta'), not negative. The friction
    force is mu(v) N, with the sliding speed v at the contact point. Equal and opposite forces act on both bodies there.

    Surfaces of j: ``line``, the axis of j, solid on the side away from j's normal; ``circle``, solid inside
    `surface_radius`; ``hole``, solid outside of it.

    Without friction and dissipation the element is conservative, with the potential k delta^(n+1)/(n+1).

    For a coefficient of restitution e at an impact speed v, near e = 1, chi = 3 (1 - e) / (2 v) (Hunt and Crossley, J.
    Appl. Mech. 42, 1975, 440-445) or 3 (1 - e^2) / (4 v) (Lankarani and Nikravesh, J. Mech. Des. 112, 1990, 369-376).
    For any e, chi = 8 (1 - e) / (5 e v) (Flores and others, Multibody Syst. Dyn. 25, 2011, 357-375).
    """

    kind: ClassVar[str] = "contact"
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"radius": 0.1},
        {"radius": 0.1, "friction": 0.3},
        {"radius": 0.1, "surface": "circle", "surface_radius": 0.1},
    )
    reflected: ClassVar[dict[str, str] | None] = {"j": "y"}
    surfaces: ClassVar[tuple[str, str, str]] = ("line", "circle", "hole")
    about: ClassVar[str] = "circle"

    i: Marker = Field(description="the point, or the circle's centre")
    j: Marker = Field(description="on the surface line, its normal pointing out of the solid, or the surface's centre")
    radius: si.LengthOrZero = Field(0.0, description="of the circle about i, m; 0 for a point")
    surface: Literal["line", "circle", "hole"] = Field("line", description="what i meets")
    surface_radius: si.LengthOrZero = Field(0.0, description="of a circle or hole about j, m")

    @staticmethod
    def out_of(e: Symbolic) -> Any:
        return e.j.normal

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        """Return N on the gap, and -mu(v) N on the sliding displacement at the contact point."""
        pressure = Contact.pressure(e)
        pairs = [(pressure, Contact.gap(e))]
        if e.friction is None:
            return pairs
        sliding = Contact.sliding(e)
        v = sum(weight * e.rate(coordinate) for weight, coordinate in sliding)
        friction = -Friction.coefficient(e, v) * pressure
        return pairs + [(friction * weight, coordinate) for weight, coordinate in sliding]

    @staticmethod
    def sliding(e: Symbolic) -> list[tuple[Any, Any]]:
        """Return weights and coordinates: the sum of weight times rate is the sliding speed at the contact point.

        That point is `radius` from i and the rest of the distance from j, both along the normal.
        """
        d = e.i.point - e.j.point
        outward = Contact.outward(e)
        if not outward:
            return [(1, d.dot(e.j.axis) + e.radius * (e.i.angle - e.j.angle))]
        distance = e.distance(e.i.point, e.j.point)
        arm = outward * distance - e.radius
        across = outward / distance
        return [(across * d[1], d[0]), (-across * d[0], d[1]), (e.radius, e.i.angle), (arm, e.j.angle)]

    def in_space(self, angles: Any) -> dict[str, Any]:
        from ..spatial.embedding.forces import contact

        return contact(self, angles)
