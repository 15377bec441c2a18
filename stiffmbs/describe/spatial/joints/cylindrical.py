"""Cylindrical joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...forces.friction import magnitude
from ...initial_pose import InitialPose
from ...loads import Loads
from ..branches import initially_apart
from ..marker import Marker
from ..primitives import ALIGN, ON_AXIS, align, along, angle_about_z, on_axis


class Cylindrical(Joint):
    """Sleeve on a shaft: marker i remains on the z axis of marker j, parallel to it, and can slide and rotate.

    The reaction is a force and a torque normal to the axis. Drives and couplers name one of its two coordinates:
    ``sleeve.displacement``, ``sleeve.angle``.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (cylindrical joint).
    """

    kind: ClassVar[str] = "cylindrical"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = (*ON_AXIS, *ALIGN)
    coordinates: ClassVar[tuple[str, ...]] = ("displacement", "angle")
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "tx", "ty")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the line to slide along and to turn about")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_apart(pose.model, self.i, self.j)

    def spins_with(self) -> dict[str, str]:
        return {"i": "z", "j": "z"}

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*on_axis(e.i, e.j), *align(e.i, e.j)]

    @staticmethod
    def displacement(e: Symbolic) -> Any:
        """Return the displacement of marker i along the z axis of marker j."""
        return along(e.i, e.j, e.j.z)

    @staticmethod
    def angle(e: Symbolic) -> Any:
        """Return the angle of marker i relative to marker j about z."""
        return angle_about_z(e)

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(*e.lam[:2]), bending=magnitude(*e.lam[2:]))
