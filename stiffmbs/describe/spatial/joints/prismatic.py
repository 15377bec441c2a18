"""Spatial prismatic (translational) joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...forces.friction import magnitude
from ...initial_pose import InitialPose
from ...loads import Loads
from ..branches import initially_askew
from ..marker import Marker
from ..primitives import ON_AXIS, ORIENT, along, on_axis, orient


class Prismatic(Joint):
    """Slider: marker i remains on the z axis of marker j and keeps j's orientation.

    The reaction is a force normal to the axis and a torque of any direction.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (translational joint).
    """

    kind: ClassVar[str] = "prismatic"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = (*ON_AXIS, *ORIENT)
    coordinates: ClassVar[tuple[str, ...]] = ("displacement",)
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "tx", "ty", "tz")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the sliding body, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the line to slide along")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_askew(pose.model, self.i, self.j)

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*on_axis(e.i, e.j), *orient(e.i, e.j)]

    @staticmethod
    def displacement(e: Symbolic) -> Any:
        """Return the displacement of marker i along the z axis of marker j."""
        return along(e.i, e.j, e.j.z)

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(*e.lam[:2]), torsion=magnitude(e.lam[2]), bending=magnitude(*e.lam[3:]))
