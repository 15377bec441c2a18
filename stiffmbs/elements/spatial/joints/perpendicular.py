"""Perpendicular axes."""

from __future__ import annotations

from ..primitives import ACROSS, SpatialJoint


class Perpendicular(SpatialJoint):
    """Joint that keeps the z axes of two markers perpendicular, at any positions.

    The reaction is a torque normal to both axes. This is Adams' PERPENDICULAR.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (dot 1 constraint).
    """

    kind = "perpendicular"
    conditions = (ACROSS,)
    forms = ({"i": {"body": "a", "orientation": {"z": (1, 0, 0)}}},)
