"""Point on a line in space."""

from __future__ import annotations

from pydantic import Field

from ..marker import Marker
from ..primitives import ON_AXIS, SpatialJoint


class PointOnLine(SpatialJoint):
    """Bead on a wire: the point of marker i remains on the z axis of marker j, in any orientation.

    The reaction is a force normal to the line, without friction. This is Adams' INLINE.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (two dot 2 constraints).
    """

    kind = "point_on_line"
    spin_conditions = {"i": "point"}
    conditions = (ON_AXIS,)
    coordinates = ("displacement",)
    elastic = "bushing"

    i: Marker = Field(description="marker of the body with the point, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the line")
