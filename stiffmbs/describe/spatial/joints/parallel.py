"""Parallel axes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_apart
from ..marker import Marker
from ..primitives import ALIGN, align


class Parallel(Joint):
    """Joint that keeps the z axes of two markers parallel or opposite, at any positions.

    The reaction is a torque normal to the axes. This is Adams' PARALLEL_AXES.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (parallel 1 constraint).
    """

    kind: ClassVar[str] = "parallel"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = ALIGN
    transmits: ClassVar[tuple[str, ...]] = ("tx", "ty")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_apart(pose.model, self.i, self.j)

    @staticmethod
    def position(e: Symbolic) -> Any:
        return align(e.i, e.j)
