"""Contact of a point or circle with a line or circle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from ...reading.fields import Measured
from ...reading.marker import Marker
from ...reading.units import si
from ..element import Expr, Matrix, Symbolic, sp
from .friction import Friction


class PressedSurfaces(Friction):
    """Base of contacts by the law of Hunt and Crossley; scenes use its subclasses.

    With the penetration delta = -gap > 0 the normal force is N = k delta^n (1 + chi delta'), not negative.
    """

    stiffness: si.PositiveValue = Field(description="k, N/m^n")
    exponent: Annotated[float, Measured("number", at_least=1)] = Field(1.5, description="n; 1.5 for Hertz's contact")
    dissipation: Annotated[float, Measured("value", at_least=0)] = Field(0.0, description="chi, s/m")

    @model_validator(mode="after")
    def _has_both_coefficients(self) -> Self:
        if self.static_friction is not None and self.friction is None:
            raise ValueError("found static_friction without friction, expected both")
        return self

    @classmethod
    def gap(cls, e: Symbolic) -> Expr:
        """Return the distance of the surfaces, m; negative for a penetration."""
        raise NotImplementedError

    @classmethod
    def opening(cls, e: Symbolic) -> Expr:
        """Return the rate of the gap, m/s."""
        return e.rate(e.named(cls.gap(e)))

    @classmethod
    def pressure(cls, e: Symbolic) -> Expr:
        """Return the normal force N, zero without contact."""
        gap = e.named(cls.gap(e))
        damped = e.named(1 - e.dissipation * cls.opening(e))
        return sp.Piecewise((e.stiffness * (-gap) ** e.exponent * damped, sp.And(gap < 0, damped > 0)), (0, True))

    @classmethod
    def event_functions(cls, e: Symbolic) -> Sequence[Expr]:
        """Return an expression that is positive while N > 0; dissipation can end N before the surfaces separate."""
        return (sp.Min(-e.named(cls.gap(e)), 1 - e.dissipation * cls.opening(e)),)


class ContactLaw(PressedSurfaces):
    """Base of contacts with a flat or round surface; scenes use its subclasses.

    Without friction and dissipation it has the potential k delta^(n+1)/(n+1).

    The surface of j is flat, round and solid inside `surface_radius`, or round and solid outside of it. `surfaces`
    contains the names of these three, and `about` the name of the round surface of i.
    """

    surfaces: ClassVar[tuple[str, str, str]]
    about: ClassVar[str]

    if TYPE_CHECKING:  # fields of the subclasses
        radius: float
        surface: str
        surface_radius: float

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _, solid, hollow = self.surfaces
        if self.surface == solid and self.radius + self.surface_radius == 0:
            raise ValueError("found two points, expected a radius or surface_radius above zero")
        if self.surface == hollow and self.surface_radius <= self.radius:
            raise ValueError(
                f"found a {self.about} of radius {self.radius:g} in a {hollow} of {self.surface_radius:g}, expected a wider {hollow}"
            )
        return self

    @classmethod
    def outward(cls, e: Symbolic) -> int:
        """Return 1 for a round surface that is solid inside, -1 for one that is solid outside, 0 for a flat one."""
        return (0, 1, -1)[cls.surfaces.index(e.surface)]

    @staticmethod
    def out_of(e: Symbolic) -> Matrix:
        """Return the outward normal of marker j's flat surface."""
        raise NotImplementedError

    @classmethod
    def gap(cls, e: Symbolic) -> Expr:
        outward = cls.outward(e)
        if not outward:
            return (e.i.point - e.j.point).dot(cls.out_of(e)) - e.radius
        return outward * (e.distance(e.i.point, e.j.point) - e.surface_radius) - e.radius

    @classmethod
    def potential(cls, e: Symbolic) -> Expr:
        gap, power = cls.gap(e), e.exponent + 1
        return sp.Piecewise((e.stiffness * (-gap) ** power / power, gap < 0), (0, True))


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

    kind = "contact"
    forms = (
        {"radius": ...},
        {"radius": ..., "friction": 0.3},
        {"radius": ..., "surface": "circle", "surface_radius": ...},
    )
    reflected = {"j": "y"}
    surfaces = ("line", "circle", "hole")
    about = "circle"

    i: Marker = Field(description="the point, or the circle's centre")
    j: Marker = Field(description="on the surface line, its normal pointing out of the solid, or the surface's centre")
    radius: si.LengthOrZero = Field(0.0, description="radius of the circle about i, m; 0 for a point")
    surface: Literal["line", "circle", "hole"] = Field("line", description="shape of the surface at j that i touches")
    surface_radius: si.LengthOrZero = Field(0.0, description="radius of a circle or hole about j, m")

    @staticmethod
    def out_of(e: Symbolic) -> Matrix:
        return e.j.normal

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
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
    def sliding(e: Symbolic) -> list[tuple[Expr, Expr]]:
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
