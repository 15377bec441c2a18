"""Screw joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from ...element import Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_apart
from ..primitives import ALIGN, ON_AXIS, align, along, angle_about_z, on_axis
from .thread import Thread


class Screw(Thread):
    """Nut on a spindle: marker i stays on the z axis of marker j, parallel to it, and a turn carries it on by the pitch.

    A cylindrical joint with the thread's equation, s - pitch theta/(2 pi) - offset = 0.  (Adams'
    SCREW is the thread's equation alone: `thread`.)  The joint leaves one freedom; drives and couplers name the
    coordinate that they mean, ``spindle.displacement`` or ``spindle.angle``.

    The reaction is a force and a torque, of which those along the axis do no work together.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (screw joint).
    """

    kind: ClassVar[str] = "screw"
    reflected: ClassVar[dict[str, str] | None] = {"pitch": "pitch", "offset": "z"}
    equations: ClassVar[tuple[str, ...]] = (*ON_AXIS, *ALIGN, *Thread.equations)
    coordinates: ClassVar[tuple[str, ...]] = ("displacement", "angle")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_apart(pose.model, self.i, self.j)

    @classmethod
    def position(cls, e: Symbolic) -> Any:
        return [*on_axis(e.i, e.j), *align(e.i, e.j), *super().position(e)]

    @staticmethod
    def displacement(e: Symbolic) -> Any:
        """The displacement of marker i along the z axis of marker j."""
        return along(e.i, e.j, e.j.z)

    @staticmethod
    def angle(e: Symbolic) -> Any:
        """The angle of marker i against marker j about z."""
        return angle_about_z(e)
