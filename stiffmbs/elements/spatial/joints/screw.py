"""Screw joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ...element import Expr, Symbolic
from ...initial_pose import InitialPose
from ..primitives import ALIGN, SpatialJoint
from .cylindrical import Cylindrical
from .thread import Thread


class Screw(Thread):
    """Nut on a spindle: marker i remains on the z axis of marker j, parallel to it, and advances by the pitch per turn.

    It is a cylindrical joint with the thread's equation, s - pitch theta/(2 pi) - offset = 0. (Adams' SCREW is the
    thread's equation alone: `thread`.) The joint leaves one degree of freedom; drives and couplers name one coordinate,
    ``spindle.displacement`` or ``spindle.angle``.

    The reaction is a force and a torque; the total power of their components along the axis is zero.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (screw joint).
    """

    kind = "screw"
    reflected = {"pitch": "pitch", "offset": "z"}
    equations = (*Cylindrical.equations, *Thread.equations)
    coordinates = ("displacement", "angle")
    displacement: ClassVar = staticmethod(SpatialJoint.displacement)
    angle: ClassVar = staticmethod(SpatialJoint.angle)

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from ALIGN.initially(pose, self.i, self.j)

    @classmethod
    def position(cls, e: Symbolic) -> list[Expr]:
        return [*Cylindrical.position(e), *super().position(e)]
