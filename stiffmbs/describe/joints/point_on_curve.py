"""Point on a smooth curve: a curved slot, or a cam with a pointed follower."""

from __future__ import annotations

from typing import Any, ClassVar

from ..element import Symbolic
from ..marker import Marker
from .curve import Curve


class PointOnCurve(Curve[Marker]):
    """Point-follower: the point of marker i stays on a curve fixed to marker j.

    In the axes of marker j the point is at (x, y), or at the distance rho in the direction theta (-pi .. pi).  The curve is a slot
    ``y`` = Y(x), with y - Y(x) = 0, or a cam ``radius`` = R(theta), with rho - R(theta) = 0.  R has to repeat after
    every turn, so that it does not matter where the arctangent jumps, nor how often the cam has turned.
    Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), section 4.2.6.

    The curve should have no breakpoints.  The reaction is across the curve, without friction, and may pull: the point
    cannot lift off.
    """

    kind: ClassVar[str] = "point_on_curve"

    @staticmethod
    def position(e: Symbolic) -> Any:
        """y - Y(x) of a slot, rho - R(theta) of a cam, in the axes of marker j."""
        d = e.i.point - e.j.point
        if e.y is not None:
            return [d.dot(e.j.normal) - e.y(d.dot(e.j.axis))]
        from sympy import atan2

        return [e.distance(e.i.point, e.j.point) - e.radius(atan2(d.dot(e.j.normal), d.dot(e.j.axis)))]
