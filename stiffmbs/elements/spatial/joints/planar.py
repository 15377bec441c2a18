"""Planar joint."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from ...element import Expr, Symbolic
from ..branches import initially_apart
from ..marker import Marker
from ..primitives import ALIGN, IN_PLANE, SpatialJoint, align, along


class Planar(SpatialJoint):
    """Sliding and rotation in a plane: the point of marker i remains in the xy plane of marker j, with parallel z axes.

    The reaction is a force along z and a torque normal to it. This is Adams' PLANAR.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (parallel 1 and dot 2
    constraints); Nikravesh (1988), section 7.2.
    """

    kind = "planar"
    equations = (*IN_PLANE, *ALIGN)
    further_coordinates = ("displacement_x", "displacement_y", "angle")
    transmits = ("fz", "tx", "ty")
    elastic = "bushing"
    initially: ClassVar = staticmethod(initially_apart)

    j: Marker = Field(description="marker whose xy plane is the plane of sliding")

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [along(e.i, e.j, e.j.z), *align(e.i, e.j)]
