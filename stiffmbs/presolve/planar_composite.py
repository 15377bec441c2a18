"""Composition of placements in the plane, and composite bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..elements.body import Body
from ..elements.turns import TURN, full_turns
from ..reading.marker import Placement


def on(frame: Placement, placed: Placement) -> Placement:
    """Return a placement that is given in a frame, in the axes in which the frame is given."""
    (x, y), (xi, eta), (c, s) = frame.point, placed.point, (math.cos(frame.angle), math.sin(frame.angle))
    return Placement(point=(x + c * xi - s * eta, y + s * xi + c * eta), angle=frame.angle + placed.angle)


def inverse(placed: Placement) -> Placement:
    """Return the inverse of a placement."""
    (x, y), (c, s) = placed.point, (math.cos(placed.angle), math.sin(placed.angle))
    return Placement(point=(-c * x - s * y, s * x - c * y), angle=-placed.angle)


def composite(members: Sequence[tuple[Body, Placement]]) -> tuple[Body, list[Placement]]:
    """Return the composite of several bodies, and the placement of each member on it.

    Masses and first moments are added; inertias with the parallel axis theorem, m d^2. `members`: with the placement of
    each centre of mass and axes in those of the first.
    """
    first, _ = members[0]
    mass = sum(body.mass for body, _ in members)
    xi, eta = (sum(body.mass * placed.point[k] for body, placed in members) / mass for k in (0, 1))
    inertia = sum(body.inertia + body.mass * math.dist(placed.point, (xi, eta)) ** 2 for body, placed in members)
    (x, y), (c, s) = first.position, (math.cos(first.angle), math.sin(first.angle))
    position = (x + c * xi - s * eta, y + s * xi + c * eta)
    body = Body(mass=mass, inertia=inertia, position=position, angle=first.angle)
    from_centre = Placement(point=(-xi, -eta))
    return body, [_as_drawn(body, own, on(from_centre, placed)) for own, placed in members]


def _as_drawn(whole: Body, own: Body, placed: Placement) -> Placement:
    """Return the placement of a member, in the turn in which the member is drawn."""
    turns = full_turns(whole.angle + placed.angle, own.angle)
    return Placement(point=placed.point, angle=placed.angle - TURN * turns)
