"""Planar joint."""

from __future__ import annotations

from pydantic import Field

from ..marker import Marker
from ..primitives import ALIGN, IN_PLANE, SpatialJoint


class Planar(SpatialJoint):
    """Sliding and rotation in a plane: the point of marker i remains in the xy plane of marker j, with parallel z axes.

    The reaction is a force along z and a torque normal to it. This is Adams' PLANAR.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (parallel 1 and dot 2
    constraints); Nikravesh (1988), section 7.2.
    """

    kind = "planar"
    conditions = IN_PLANE, ALIGN
    further_coordinates = ("displacement_x", "displacement_y", "angle")
    elastic = "bushing"

    j: Marker = Field(description="marker whose xy plane is the plane of sliding")
