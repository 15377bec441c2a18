"""Cylindrical joint."""

from __future__ import annotations

from pydantic import Field

from ...element import Symbolic
from ...loads import Loads, magnitude
from ..marker import Marker
from ..primitives import ALIGN, ON_AXIS, SpatialJoint


class Cylindrical(SpatialJoint):
    """Sleeve on a shaft: marker i remains on the z axis of marker j, parallel to it, and can slide and rotate.

    The reaction is a force and a torque normal to the axis. Drives and couplers name one of its two coordinates:
    ``sleeve.displacement``, ``sleeve.angle``.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (cylindrical joint).
    """

    kind = "cylindrical"
    spin_conditions = {"i": "z", "j": "z"}
    conditions = ON_AXIS, ALIGN
    coordinates = ("displacement", "angle")
    elastic = "bushing"

    j: Marker = Field(description="marker whose z axis is the line of sliding and the axis of rotation")

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(e, *e.lam[:2]), bending=magnitude(e, *e.lam[2:]))
