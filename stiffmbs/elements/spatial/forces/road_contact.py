"""Contact of a sphere or point of a body with a road."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Matrix, Symbolic
from ...forces.contact import PressedSurfaces
from ...roads.field import ROAD
from ...roads.road import FlatRoad, Road
from ..contact_point import surface
from ..marker import Marker
from ..wrench import Pairs, velocity


class Touch(NamedTuple):
    """Gap, m; outward normal of the road; velocity at the contact point relative to the road, m/s; factor on friction."""

    gap: Expr
    normal: Matrix
    velocity: Matrix
    factor: Expr


class RoadContact(PressedSurfaces):
    """Contact of a sphere or point about marker i with a road, such as of a corner of a car that rolls over.

    With the penetration delta = -gap > 0 the normal force is N = k delta^n (1 + chi delta'), not negative; delta' is
    the velocity into the road. The friction force is mu(v) N times the friction factor of the road, opposite to the
    sliding velocity at the contact point. The normal is that of the road at the foot of the perpendicular from the
    sphere's centre, found in one step from the point below it. Its direction is off by the square of the radius over the
    radius of curvature of the road, relative to its slope. energy.total does not include the elastic energy. The law is
    that of the planar `contact`, with its sources.
    """

    kind = "road_contact"
    forms = ({"radius": ...}, {"radius": ..., "friction": 0.3})
    reflected = {"j": "z"}
    may_keep_energy = False

    i: Marker = Field(description="the point, or the sphere's centre")
    j: Marker | None = Field(
        None,
        description="marker with the axes x, y and z of the road, on the body that carries the road; ground by default",
    )
    road: Annotated[Road, ROAD] = Field(
        FlatRoad.model_construct(type=FlatRoad.kind),
        description="the name of a road of the scene, or a road; level at z = 0 by default",
    )
    radius: si.LengthOrZero = Field(0.0, description="radius of the sphere about i, m; 0 for a point")

    @classmethod
    def touch(cls, e: Symbolic) -> Touch:
        """Return the contact with the tangent plane of the road."""
        centre = e.named(e.i.point)
        along, across, below, n = surface(e, centre)
        if not e.road.level:
            foot = e.named(centre - below * n)
            along, across, more, n = surface(e, foot)
            below = e.named((centre - foot).dot(n) + more)
        point = e.named(centre - e.radius * n)
        v = velocity(e, e.i, point) - (velocity(e, e.j, point) if e.j is not None else 0 * n)
        return Touch(e.named(below - e.radius), n, e.named(v), e.road.factor(along, across))

    @classmethod
    def gap(cls, e: Symbolic) -> Expr:
        return cls.touch(e).gap

    @classmethod
    def opening(cls, e: Symbolic) -> Expr:
        """Return the velocity out of the road, m/s."""
        touch = cls.touch(e)
        return touch.velocity.dot(touch.normal)

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the force at the contact point on i's body, and the opposite on the road's body."""
        touch, pressure = cls.touch(e), e.named(cls.pressure(e))
        force = pressure * touch.normal
        if e.friction is not None:
            sliding = e.named(touch.velocity - touch.velocity.dot(touch.normal) * touch.normal)
            force = force - e.named(cls.per_speed(e, *sliding) * pressure * touch.factor) * sliding
        return list(zip(e.named(force), touch.velocity, strict=True))
