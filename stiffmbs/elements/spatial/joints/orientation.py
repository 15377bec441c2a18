"""Orientation joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from ...element import Expr, Symbolic
from ..branches import initially_rotated
from ..primitives import ORIENT, SpatialJoint, orient


class Orientation(SpatialJoint):
    """Joint that keeps the axes of two markers parallel, at any positions.

    The reaction is a torque of any direction. This is Adams' ORIENTATION.

    The equations have seven other solutions (half turns and third turns), so markers drawn 60 degrees or more apart are
    refused.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (three dot 1 constraints).
    """

    kind = "orientation"
    symmetric_with = {"i": "body", "j": "body"}
    equations = ORIENT
    further_coordinates = ("displacement_x", "displacement_y", "displacement_z")
    transmits = ("tx", "ty", "tz")
    elastic = "bushing"
    initially: ClassVar = staticmethod(initially_rotated)

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        return orient(e.i, e.j)
