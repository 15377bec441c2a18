"""Perpendicular axes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_aligned
from ..marker import Marker
from ..primitives import ACROSS, perpendicular


class Perpendicular(Joint):
    """Joint that keeps the z axes of two markers perpendicular, at any positions.

    The reaction is a torque normal to both axes. This is Adams' PERPENDICULAR.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (dot 1 constraint).
    """

    kind: ClassVar[str] = "perpendicular"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = ACROSS
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = ({"i": {"body": "a", "orientation": {"z": (1, 0, 0)}}},)

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_aligned(pose.model, self.i, self.j)

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [perpendicular(e.i.z, e.j.z)]
