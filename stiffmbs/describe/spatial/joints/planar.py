"""Planar joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_apart
from ..marker import Marker
from ..primitives import ALIGN, IN_PLANE, align, along


class Planar(Joint):
    """Sliding and rotation in a plane: the point of marker i remains in the xy plane of marker j, with parallel z axes.

    The reaction is a force along z and a torque normal to it. This is Adams' PLANAR.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (parallel 1 and dot 2
    constraints); Nikravesh (1988), section 7.2.
    """

    kind: ClassVar[str] = "planar"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = (*IN_PLANE, *ALIGN)
    transmits: ClassVar[tuple[str, ...]] = ("fz", "tx", "ty")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker whose xy plane is the one to slide on")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_apart(pose.model, self.i, self.j)

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [along(e.i, e.j, e.j.z), *align(e.i, e.j)]
