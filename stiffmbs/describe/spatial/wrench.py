"""Forces and torques in space as pairs of an effort and a rate: what `Force.powers` returns.

All vectors are in ground axes; i and j are markers.  Action equals reaction at one point of space, so that two bodies
keep their momentum and their angular momentum whatever the force is.
"""

from __future__ import annotations

from typing import Any

from ..element import Symbolic

Pairs = list[tuple[Any, Any]]


def velocity(e: Symbolic, marker: Any, point: Any) -> Any:
    """The velocity of that point of a marker's body which is at a point of space."""
    return e.rate(marker.body.origin) + marker.omega.cross(point - marker.body.origin)


def force_at(e: Symbolic, force: Any, i: Any, j: Any = None) -> Pairs:
    """A force on the body of i at i's point; with j the opposite one on j's body at the same point of space."""
    rates = e.rate(i.point)
    return list(zip(force, rates if j is None else rates - velocity(e, j, i.point), strict=True))


def torque_on(torque: Any, i: Any, j: Any = None) -> Pairs:
    """A torque on the body of i; with j the opposite one on j's body."""
    return list(zip(torque, i.omega if j is None else i.omega - j.omega, strict=True))


def along_axes(components: Any, axes: Any) -> Any:
    """The vector whose components along three axes, such as a marker's, are given."""
    (x, y, z), (along_x, along_y, along_z) = components, axes
    return x * along_x + y * along_y + z * along_z
