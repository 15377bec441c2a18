"""Rod with a revolute and a spherical end."""

from __future__ import annotations

from pydantic import Field

from ...element import Expr, Symbolic
from ...joints.distance import Rod
from ..marker import Marker
from ..primitives import IN_PLANE, along


class RevoluteSpherical(Rod[Marker]):
    """Massless rod with a hinge at marker j and a ball at marker i.

    The point of marker i remains at a distance L from that of marker j, (d . d - L^2)/(2 L) = 0, and in the plane
    normal to the hinge axis z_j, d . z_j = 0. The reaction is a force on the ball, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (revolute-spherical composite
    joint).
    """

    kind = "revolute_spherical"
    reflected = {}
    equations = (*Rod.equations, *IN_PLANE.rows)
    further_coordinates = ("angle_1",)

    i: Marker = Field(description="marker of the body with the ball, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the hinge's")

    @staticmethod
    def angle_1(e: Symbolic) -> Expr:
        """Return the angle of the rod about the hinge axis j.z, from j.x."""
        d = e.i.point - e.j.point
        return e.angle(d.dot(e.j.y), d.dot(e.j.x))

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [*Rod.position(e), along(e.i, e.j, e.j.z)]
