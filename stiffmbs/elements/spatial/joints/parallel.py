"""Parallel axes."""

from __future__ import annotations

from ..primitives import ALIGN, SpatialJoint


class Parallel(SpatialJoint):
    """Joint that keeps the z axes of two markers parallel or opposite, at any positions.

    The reaction is a torque normal to the axes. This is Adams' PARALLEL_AXES.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (parallel 1 constraint).
    """

    kind = "parallel"
    conditions = (ALIGN,)
    further_coordinates = ("displacement_x", "displacement_y", "displacement_z", "angle")
    elastic = "bushing"
