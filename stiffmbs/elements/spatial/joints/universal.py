"""Universal joint."""

from __future__ import annotations

from pydantic import Field

from ...element import Expr, Symbolic
from ..marker import Marker
from ..primitives import ACROSS, COINCIDE, SpatialJoint


class Universal(SpatialJoint):
    """Cardan joint: two points coincide, and the z axes of both markers, the arms of its cross, are perpendicular.

    Each body rotates about its own arm. The reaction is a force of any direction, and a torque normal to both arms.
    Its coordinates are ``angle_1`` of the cross about j.z, from j.x to i.z, and ``angle_2`` of marker i about i.z, from
    j.z to i.x. This is Adams' UNIVERSAL; its HOOKE, whose markers have z along the shafts, has the arms i.x and j.y.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (universal joint).
    """

    kind = "universal"
    known_as = ("cardan", "hooke")
    conditions = COINCIDE, ACROSS
    further_coordinates = ("angle_1", "angle_2")
    forms = ({"i": {"body": "a", "orientation": {"z": (1, 0, 0)}}},)

    i: Marker = Field(
        description="marker of the first body, z along its arm of the cross; the reaction is reported on it"
    )
    j: Marker = Field(description="marker of the second body, z along its arm")

    @staticmethod
    def angle_1(e: Symbolic) -> Expr:
        """Return the angle of the cross about the arm j.z, from j.x to i.z."""
        return e.angle(e.i.z.dot(e.j.y), e.i.z.dot(e.j.x))

    @staticmethod
    def angle_2(e: Symbolic) -> Expr:
        """Return the angle of marker i about its arm i.z relative to the cross, from j.z to i.x."""
        return e.angle(-e.i.y.dot(e.j.z), e.i.x.dot(e.j.z))
