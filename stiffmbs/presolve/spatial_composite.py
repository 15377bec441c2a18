"""Composition of placements in space, and composite bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..elements.spatial.body import Body
from ..elements.spatial.marker import Placement
from ..elements.spatial.orientation import conjugate, matrix, product, rotated


def on(frame: Placement, placed: Placement) -> Placement:
    """Return a placement that is given in a frame, in the axes in which the frame is given."""
    point = np.array(frame.point) + rotated(frame.orientation, placed.point)
    return Placement(point=_numbers(point), orientation=product(frame.orientation, placed.orientation))


def inverse(placed: Placement) -> Placement:
    """Return the inverse of a placement."""
    back = conjugate(placed.orientation)
    return Placement(point=_numbers(-rotated(back, placed.point)), orientation=back)


def composite(members: Sequence[tuple[Body, Placement]]) -> tuple[Body, list[Placement]]:
    """Return the composite of several bodies, and the placement of each member on it, by centres and principal axes.

    Masses and first moments are added; rotated inertia tensors with m (d^2 - d d^T) (parallel axis theorem). `members`:
    with the placement of each centre of mass and principal axes in those of the first.
    """
    first, _ = members[0]
    mass = sum(body.mass for body, _ in members)
    centre = np.sum([body.mass * np.array(placed.point) for body, placed in members], axis=0) / mass
    inertia = np.zeros((3, 3))
    for body, placed in members:
        turn, arm = matrix(placed.orientation), np.array(placed.point) - centre
        inertia += turn @ np.diag(body.principal_moments()) @ turn.T
        inertia += body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    x, y, z, *orientation = first.coordinates()
    rows = tuple(_numbers(row) for row in (inertia + inertia.T) / 2)
    body = Body(
        mass=mass, inertia=rows, center_of_mass=_numbers(centre), position=(x, y, z), orientation=tuple(orientation),
        any_moments=any(body.any_moments for body, _ in members),
    )  # fmt: skip
    return body, [_as_drawn(body, own, body.carried(placed)) for own, placed in members]


def _as_drawn(whole: Body, own: Body, placed: Placement) -> Placement:
    """Return the pose of a member, with the sign of the quaternion with which the member is drawn.

    Elastic connections measure angles beyond half a turn by the sign of the quaternion.
    """
    (*_, w, x, y, z), (*_, a, b, c, d) = whole.coordinates(), own.coordinates()
    turned = product((w, x, y, z), placed.orientation)
    if np.dot(turned, (a, b, c, d)) >= 0:
        return placed
    p, q, r, s = placed.orientation
    return Placement(point=placed.point, orientation=(-p, -q, -r, -s))


def _numbers(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(part) for part in vector)
    return x, y, z
