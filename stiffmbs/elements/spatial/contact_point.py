"""Contact point of a wheel with a road, and slip at this point.

The contact point is in the wheel's plane below its centre. It is on the line through the centre that is perpendicular
to the spin axis and to the wheel's heading (Pacejka, Tire and Vehicle Dynamics, 2012, sec. 2.2 and 9.2).
"""

from __future__ import annotations

from dataclasses import dataclass

from ..element import Expr, Matrix, Symbolic, sp
from ..roads.envelope import enveloped
from ..roads.road import above_zero, magnitude
from .wrench import along_axes, seen_from, velocity


@dataclass(frozen=True)
class ContactPoint:
    """Contact of a wheel with a road, in ground axes."""

    point: Matrix  # contact point, m
    # forward, left, normal: unit vectors of the ISO axes at the contact: the wheel's heading in the road plane, across
    # it, normal to the road
    forward: Matrix
    left: Matrix
    normal: Matrix
    radius: Expr  # loaded radius, from the wheel's centre to the contact point, m
    camber: Expr  # angle of the wheel's plane to the road normal, rad; positive if the top leans to the right
    # vx, vy, vz: velocity of the contact point, which does not rotate with the wheel, along these axes, m/s
    vx: Expr
    vy: Expr
    vz: Expr
    spin: Expr  # angular velocity of the wheel about its axis, rad/s; positive rolling forward
    friction: Expr  # friction factor of the road


def contact_point(e: Symbolic) -> ContactPoint:
    """Return the contact of the wheel of marker i, whose y axis is its spin axis, with the road of j."""
    centre, axis = e.named(e.i.point), e.named(e.i.y)
    enveloping = e.envelope is not None and not e.road.level
    x, y, below, n = _effective_surface(e, centre, axis) if enveloping else surface(e, centre)
    forward, up = _heading(e, axis, n)
    radius = e.named(below / up.dot(n))
    if not e.road.level and not enveloping:
        point = e.named(centre - radius * up)
        x, y, below, n = surface(e, point)
        forward, up = _heading(e, axis, n)
        radius = e.named(radius + below / up.dot(n))
    left = e.named(n.cross(forward))
    arm = e.named(-radius * up)
    spin, v = _motion(e, centre, axis, arm)
    vx, vy, vz = (e.named(v.dot(along)) for along in (forward, left, n))
    camber, friction = e.named(sp.asin(axis.dot(n))), e.named(e.road.factor(x, y))
    return ContactPoint(e.named(centre + arm), forward, left, n, radius, camber, vx, vy, vz, spin, friction)


def surface(e: Symbolic, point: Matrix) -> tuple[Expr, Expr, Expr, Expr]:
    """Return a point's coordinates along and across the road, its distance from the tangent plane, and the normal."""
    local = point if e.j is None else seen_from(point, e.j)
    x, y = e.variable(local[0]), e.variable(local[1])
    along, across = e.road.place(e, x, y)
    height = e.named(e.road.surface(along, across))
    slopes = e.named([e.slope(height, x), e.slope(height, y)])
    return along, across, *_plane(e, local[2] - height, slopes)


def _effective_surface(e: Symbolic, centre: Matrix, axis: Matrix) -> tuple[Expr, Expr, Expr, Expr]:
    """Return the same for the effective plane of the cams of an enveloping tyre."""
    local = centre if e.j is None else seen_from(centre, e.j)
    direction = axis if e.j is None else [axis.dot(along) for along in (e.j.x, e.j.y, e.j.z)]
    x, y = e.named(local[0]), e.named(local[1])
    height, *slopes = enveloped(e, x, y, direction)
    along, across = e.road.place(e, x, y)
    return along, across, *_plane(e, local[2] - height, slopes)


def _plane(e: Symbolic, above: Expr, slopes: list[Expr]) -> tuple[Expr, Matrix]:
    """Return the distance of a point from a plane, given its height above it, and the plane's normal."""
    upright = e.named(1 / sp.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2))
    components = sp.Matrix([-slopes[0] * upright, -slopes[1] * upright, upright])
    n = components if e.j is None else along_axes(components, e.j.axes)
    return e.named(above * upright), e.named(n)


def _heading(e: Symbolic, axis: Matrix, n: Matrix) -> tuple[Matrix, Matrix]:
    """Return the wheel's heading in the road plane, and the direction in the wheel's plane away from the road."""
    across = e.named(axis.cross(n))
    forward = e.named(across / sp.sqrt(across.dot(across)))
    return forward, e.named(forward.cross(axis))


def _motion(e: Symbolic, centre: Matrix, axis: Matrix, arm: Matrix) -> tuple[Expr, Matrix]:
    """Return the spin, and the velocity of the contact point, both relative to the road."""
    omega, v = e.named(e.i.omega), e.rate(e.i.point)
    if e.j is not None:
        omega = e.named(omega - e.j.omega)
        v = v - velocity(e, e.j, centre)
    spin = e.named(omega.dot(axis))
    return spin, e.named(v + (omega - spin * axis).cross(arm))


def slips(e: Symbolic, contact: ContactPoint, sliding: Expr, slow: Expr) -> tuple[Expr, Expr, Expr]:
    """Return the steady-state longitudinal slip, the tangent of the slip angle, and their reference speed.

    kappa = -Vsx/V and tan(alpha) = Vy/V, with the sliding velocity Vsx = Vx - Re Omega and V = abs(Vx). Below the speed
    `slow` V = (slow^2 + Vx^2)/(2 slow), which is smooth at zero speed.
    """
    forward = magnitude(contact.vx)
    missing = above_zero(e.named(slow - forward))
    speed = e.named(forward + missing**2 / (2 * slow))
    return e.named(-sliding / speed), e.named(contact.vy / speed), speed


def yaw_rate(e: Symbolic, contact: ContactPoint) -> Expr:
    """Return the rate at which the heading turns about the road's normal, rad/s.

    With the angular velocity omega = yaw n + tilt x + turns y about the normal, the heading, and the spin axis, which is
    inclined by the camber, the spin is omega y = turns + yaw sin(camber).
    """
    omega = e.named(e.i.omega if e.j is None else e.i.omega - e.j.omega)
    inclined = e.named(sp.sin(contact.camber))
    return e.named((omega.dot(contact.normal) - inclined * contact.spin) / (1 - inclined**2))
