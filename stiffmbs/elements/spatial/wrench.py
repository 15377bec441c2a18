"""Spatial forces and torques as pairs of an effort and a rate, as returned by `Force.powers`.

All vectors are in ground axes; i and j are markers. Action and reaction act at the same point of space, so linear and
angular momentum of two bodies are conserved.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..element import Expr, Matrix, Symbolic, sp

if TYPE_CHECKING:
    from ...compile.symbolic.spatial_frames import SpatialFrame

Pairs = list[tuple[Expr, Expr]]


def velocity(e: Symbolic, marker: SpatialFrame, point: Matrix) -> Matrix:
    """Return the velocity of the point of a marker's body that coincides with a point of space."""
    return e.rate(marker.body.origin) + marker.omega.cross(point - marker.body.origin)


def force_at(e: Symbolic, force: Matrix, i: SpatialFrame, j: SpatialFrame | None = None) -> Pairs:
    """Return a force at i's point on i's body; with j the opposite on j's body at the same point of space."""
    rates = e.rate(i.point)
    return list(zip(force, rates if j is None else rates - velocity(e, j, i.point), strict=True))


def torque_on(torque: Matrix, i: SpatialFrame, j: SpatialFrame | None = None) -> Pairs:
    """Return a torque on i's body; with j the opposite on j's body."""
    return list(zip(torque, i.omega if j is None else i.omega - j.omega, strict=True))


def along_axes(components: Sequence[Expr], axes: Sequence[Matrix]) -> Matrix:
    """Return the vector with the given components along three axes, such as a marker's."""
    (x, y, z), (along_x, along_y, along_z) = components, axes
    return x * along_x + y * along_y + z * along_z


def seen_from(point: Matrix, marker: SpatialFrame) -> Matrix:
    """Return the components of a point relative to a marker, along its axes."""
    return sp.Matrix([(point - marker.point).dot(axis) for axis in (marker.x, marker.y, marker.z)])
