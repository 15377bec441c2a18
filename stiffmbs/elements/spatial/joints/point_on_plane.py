"""Point on a plane."""

from __future__ import annotations

from pydantic import Field

from ..marker import Marker
from ..primitives import IN_PLANE, SpatialJoint


class PointOnPlane(SpatialJoint):
    """Point on a plane: the point of marker i remains in the xy plane of marker j, in any orientation.

    The reaction is a force along z of marker j, without friction and bilateral. This is Adams' INPLANE.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (dot 2 constraint).
    """

    kind = "point_on_plane"
    spin_conditions = {"i": "point"}
    conditions = (IN_PLANE,)
    further_coordinates = ("displacement_x", "displacement_y")
    elastic = "bushing"

    i: Marker = Field(description="marker of the body with the point, on which the reaction is reported")
    j: Marker = Field(description="marker whose xy plane is the plane")
