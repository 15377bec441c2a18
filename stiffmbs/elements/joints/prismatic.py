"""Prismatic (translational) joint."""

from __future__ import annotations

from pydantic import Field

from ...reading.marker import Marker
from ..element import Expr, Symbolic
from ..loads import Loads, magnitude
from ..turns import WithinHalfATurn
from .planar_pair import PlanarPair


class Prismatic(WithinHalfATurn, PlanarPair):
    """Slider: marker i remains on the line through marker j along j's axis, and keeps j's direction.

    The reaction is a force normal to the line and a torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), eq. 3.3.13, with the angle itself in
    place of its sine.
    """

    kind = "prismatic"
    known_as = ("slider", "translational")
    equations = ("normal", "angle")
    coordinates = ("displacement",)
    elastic = "bushing"
    keeps_in_plane = True
    same_in_each_pose = True

    i: Marker = Field(description="marker of the sliding body, on which the reaction is reported")
    j: Marker = Field(description="marker whose axis is the line of sliding")

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [(e.i.point - e.j.point).dot(e.j.normal), e.i.angle - e.j.angle]

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        normal, moment = e.lam
        return Loads(across=magnitude(e, normal), bending=magnitude(e, moment))
