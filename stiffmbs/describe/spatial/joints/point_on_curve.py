"""Point on a smooth curve of a plane in space: a curved slot, or a cam with a pointed follower."""

from __future__ import annotations

from typing import Any, ClassVar

from ...element import Symbolic
from ...joints.point_on_curve import Curve
from ..marker import Marker
from ..primitives import IN_PLANE, along


class PointOnCurve(Curve[Marker]):
    """Point-follower: the point of marker i stays on a curve in the xy plane of marker j, in any orientation.

    The curve is given as in the plane: in the axes of marker j the point is at (x, y), or at the distance rho in the
    direction theta from x; a slot ``y`` = Y(x) has y - Y(x) = 0, a cam ``radius`` = R(theta) has rho - R(theta) = 0, R
    repeating after every turn.  Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), section 4.2.6.

    The curve should have no breakpoints.  The reaction is across the curve, without friction, and may pull: the point
    cannot lift off.  Of Adams' PTCV it covers the flat curves.
    """

    equations: ClassVar[tuple[str, ...]] = (*Curve.equations, *IN_PLANE)

    @staticmethod
    def position(e: Symbolic) -> Any:
        """y - Y(x) of a slot, rho - R(theta) of a cam, and the distance from the plane."""
        x, y, z = e.named([along(e.i, e.j, axis) for axis in (e.j.x, e.j.y, e.j.z)])
        if e.y is not None:
            return [y - e.y(x), z]
        from sympy import atan2, sqrt

        return [sqrt(x**2 + y**2) - e.radius(atan2(y, x)), z]
