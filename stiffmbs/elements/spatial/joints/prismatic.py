"""Spatial prismatic (translational) joint."""

from __future__ import annotations

from dataclasses import replace

from pydantic import Field

from ...element import Symbolic
from ...loads import Loads, magnitude
from ..branches import initially_askew
from ..marker import Marker
from ..primitives import ON_AXIS, ORIENT, SpatialJoint


class Prismatic(SpatialJoint):
    """Slider: marker i remains on the z axis of marker j and keeps j's orientation.

    The reaction is a force normal to the axis and a torque of any direction.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (translational joint).
    """

    kind = "prismatic"
    known_as = ("slider", "translational")
    conditions = ON_AXIS, replace(ORIENT, initially=initially_askew)
    coordinates = ("displacement",)
    elastic = "bushing"

    i: Marker = Field(description="marker of the sliding body, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the line of sliding")

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(e, *e.lam[:2]), torsion=magnitude(e, e.lam[2]), bending=magnitude(e, *e.lam[3:]))
