"""Contact of a sphere with a plane or a sphere."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ....reading.units import si
from ...element import Matrix, Symbolic
from ...forces.contact import ContactLaw
from ..marker import Marker
from ..wrench import Pairs, velocity


class SphereContact(ContactLaw):
    """Contact of a sphere or point about marker i with a plane, a sphere, or the inside of a hollow sphere.

    With the penetration delta = -gap > 0 the normal force is N = k delta^n (1 + chi delta'), not negative. The friction
    force mu(v) N is opposite to the sliding velocity of i's surface relative to j's at the contact point. Equal and
    opposite forces act on both bodies there; there is no drilling friction.

    Surfaces of j: ``plane``, the plane of x and y of j, solid on the side away from z; ``sphere``, solid inside
    `surface_radius`; ``hollow``, solid outside of it.

    Without friction and dissipation the element is conservative, with the potential k delta^(n+1)/(n+1). The sources of
    the law, and chi for a coefficient of restitution, are those of the planar `contact`.
    """

    kind = "sphere_contact"
    forms = (
        {"radius": ...},
        {"radius": ..., "friction": 0.3},
        {"radius": ..., "surface": "sphere", "surface_radius": ..., "friction": 0.3},
    )
    reflected = {"j": "z"}
    surfaces = ("plane", "sphere", "hollow")
    about = "sphere"

    i: Marker = Field(description="the point, or the sphere's centre")
    j: Marker = Field(description="on the plane, its z pointing out of the solid, or the surface's centre")
    radius: si.LengthOrZero = Field(0.0, description="radius of the sphere about i, m; 0 for a point")
    surface: Literal["plane", "sphere", "hollow"] = Field(
        "plane", description="shape of the surface at j that i touches"
    )
    surface_radius: si.LengthOrZero = Field(0.0, description="radius of a sphere or hollow sphere about j, m")

    @model_validator(mode="after")
    def _plane_without_radius(self) -> SphereContact:
        if self.surface == "plane" and self.surface_radius:
            raise ValueError("found a surface_radius of a plane, expected none")
        return self

    @staticmethod
    def out_of(e: Symbolic) -> Matrix:
        return e.j.z

    @classmethod
    def normal(cls, e: Symbolic) -> Matrix:
        """Return the outward unit normal of j's surface at the contact point."""
        outward = cls.outward(e)
        if not outward:
            return e.j.z
        return outward * (e.i.point - e.j.point) / e.distance(e.i.point, e.j.point)

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return N on the gap's rate, and friction on the sliding velocity."""
        pressure, rate = e.named(cls.pressure(e)), e.named(e.rate(cls.gap(e)))
        if e.friction is None:
            return [(pressure, rate)]
        n = e.named(cls.normal(e))
        point = e.named(e.i.point - e.radius * n)
        v = e.named(velocity(e, e.i, point) - velocity(e, e.j, point))
        sliding = e.named(v - v.dot(n) * n)
        drag = e.named(-cls.per_speed(e, *sliding) * pressure)
        return [(pressure, rate), *((drag * part, along) for part, along in zip(sliding, v, strict=True))]
