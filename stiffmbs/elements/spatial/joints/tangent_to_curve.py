"""Point and direction on a smooth planar curve in space; two of them form a curve-curve contact."""

from __future__ import annotations

from collections.abc import Sequence

from ...element import Expr, Symbolic, sp
from ...joints.point_on_curve import Curve
from ..marker import Marker
from ..primitives import IN_PLANE, along, perpendicular


class TangentToCurve(Curve[Marker]):
    """Follower with a direction: the point of marker i remains on a curve, with its x axis along the tangent.

    The curve is in the xy plane of marker j, as in `point_on_curve`: a slot ``y`` = Y(x), or a cam ``radius`` =
    R(theta). With the normal n of the curve at the point, the additional equation is x_i . n = 0, for either sense of
    the x axis. Two such joints of one light body keep two curves in contact, as Adams' CVCV.

    The curve should be free of breakpoints. The reaction has a force normal to the curve, and a torque.
    """

    kind = "tangent_to_curve"
    equations = (*Curve.equations, *IN_PLANE.rows, "tangent")

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        """Return y - Y(x) or rho - R(theta), the distance from the plane, and x_i . n with its gradient n."""
        x, y = (e.variable(along(e.i, e.j, axis)) for axis in (e.j.x, e.j.y))
        curve = e.named(_curve(e, x, y))
        gradient = e.slope(curve, x) * e.j.x + e.slope(curve, y) * e.j.y
        return [curve, along(e.i, e.j, e.j.z), perpendicular(e.i.x, gradient)]


def _curve(e: Symbolic, x: Expr, y: Expr) -> Expr:
    if e.y is not None:
        return y - e.y(x)
    return sp.sqrt(x**2 + y**2) - e.radius(sp.atan2(y, x))
