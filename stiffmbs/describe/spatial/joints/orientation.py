"""Orientation joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_rotated
from ..marker import Marker
from ..primitives import ORIENT, orient


class Orientation(Joint):
    """Joint that keeps the axes of two markers parallel, at any positions.

    The reaction is a torque of any direction. This is Adams' ORIENTATION.

    The equations have seven other solutions (half turns and third turns), so markers drawn 60 degrees or more apart are
    refused.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (three dot 1 constraints).
    """

    kind: ClassVar[str] = "orientation"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = ORIENT
    transmits: ClassVar[tuple[str, ...]] = ("tx", "ty", "tz")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_rotated(pose.model, self.i, self.j)

    @staticmethod
    def position(e: Symbolic) -> Any:
        return orient(e.i, e.j)
