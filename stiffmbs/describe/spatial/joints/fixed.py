"""Spatial fixed joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_rotated
from ..marker import Marker
from ..primitives import COINCIDE, ORIENT, coincide, orient


class Fixed(Joint):
    """Weld: two markers coincide in position and orientation.

    The reaction is a force and a torque of any direction. This is Adams' FIXED.

    The equations of orientation have seven other solutions (half turns and third turns), so markers drawn 60 degrees or
    more apart are refused.
    """

    kind: ClassVar[str] = "fixed"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = (*COINCIDE, *ORIENT)
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "fz", "tx", "ty", "tz")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_rotated(pose.model, self.i, self.j)

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*coincide(e.i, e.j), *orient(e.i, e.j)]
