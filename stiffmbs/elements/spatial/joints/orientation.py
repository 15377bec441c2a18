"""Orientation joint."""

from __future__ import annotations

from ..primitives import ORIENT, SpatialJoint


class Orientation(SpatialJoint):
    """Joint that keeps the axes of two markers parallel, at any positions.

    The reaction is a torque of any direction. This is Adams' ORIENTATION.

    The equations have seven other solutions (half turns and third turns), so markers drawn 60 degrees or more apart are
    refused.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (three dot 1 constraints).
    """

    kind = "orientation"
    conditions = (ORIENT,)
    further_coordinates = ("displacement_x", "displacement_y", "displacement_z")
    elastic = "bushing"
