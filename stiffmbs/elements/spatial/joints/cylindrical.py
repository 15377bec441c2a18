"""Cylindrical joint."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from ...element import Expr, Symbolic
from ...forces.friction import Loads, magnitude
from ..branches import initially_apart
from ..marker import Marker
from ..primitives import ALIGN, ON_AXIS, SpatialJoint, align, on_axis


class Cylindrical(SpatialJoint):
    """Sleeve on a shaft: marker i remains on the z axis of marker j, parallel to it, and can slide and rotate.

    The reaction is a force and a torque normal to the axis. Drives and couplers name one of its two coordinates:
    ``sleeve.displacement``, ``sleeve.angle``.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (cylindrical joint).
    """

    kind = "cylindrical"
    symmetric_with = {"i": "z", "j": "z"}
    equations = (*ON_AXIS, *ALIGN)
    coordinates = ("displacement", "angle")
    transmits = ("fx", "fy", "tx", "ty")
    elastic = "bushing"
    initially: ClassVar = staticmethod(initially_apart)

    j: Marker = Field(description="marker whose z axis is the line of sliding and the axis of rotation")

    def spins_with(self) -> dict[str, str]:
        return {"i": "z", "j": "z"}

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [*on_axis(e.i, e.j), *align(e.i, e.j)]

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(*e.lam[:2]), bending=magnitude(*e.lam[2:]))
