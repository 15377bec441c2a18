"""Revolute joint in space."""

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
from ..primitives import ALIGN, COINCIDE, align, angle_about_z, coincide


class Revolute(Joint):
    """Hinge: two points coincide and the axes z of both markers are one.

    The reaction is a force of any direction, and a torque across the axis.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (revolute joint).
    """

    kind: ClassVar[str] = "revolute"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = (*COINCIDE, *ALIGN)
    coordinates: ClassVar[tuple[str, ...]] = ("angle",)
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "fz", "tx", "ty")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_apart(pose.model, self.i, self.j)

    def spins_with(self) -> dict[str, str]:
        return {"i": "z", "j": "z"}

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*coincide(e.i, e.j), *align(e.i, e.j)]

    @staticmethod
    def angle(e: Symbolic) -> Any:
        """The angle of marker i against marker j about z."""
        return angle_about_z(e)

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        """Force across and along the axis, and the moment across it."""
        from sympy import Matrix

        force, z = Matrix(e.lam[:3]), e.j.z
        along = force.dot(z)
        return Loads(across=magnitude(*(force - along * z)), thrust=magnitude(along), bending=magnitude(*e.lam[3:]))
