"""Perpendicular axes."""

from __future__ import annotations

from typing import ClassVar

from ...element import Expr, Symbolic
from ..branches import initially_aligned
from ..primitives import ACROSS, SpatialJoint, perpendicular


class Perpendicular(SpatialJoint):
    """Joint that keeps the z axes of two markers perpendicular, at any positions.

    The reaction is a torque normal to both axes. This is Adams' PERPENDICULAR.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (dot 1 constraint).
    """

    kind = "perpendicular"
    equations = ACROSS
    forms = ({"i": {"body": "a", "orientation": {"z": (1, 0, 0)}}},)
    initially: ClassVar = staticmethod(initially_aligned)

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [perpendicular(e.i.z, e.j.z)]
