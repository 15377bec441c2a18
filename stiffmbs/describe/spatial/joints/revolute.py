"""Spatial revolute joint."""

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
    """Hinge: two points coincide, with the z axes of both markers parallel.

    The reaction is a force of any direction, and a torque normal to the axis.

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
        """Return the angle of marker i relative to marker j about z."""
        return angle_about_z(e)

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        """Return the force normal to and along the axis, and the moment normal to it."""
        from sympy import Matrix

        force, z = Matrix(e.lam[:3]), e.j.z
        along = force.dot(z)
        return Loads(across=magnitude(*(force - along * z)), thrust=magnitude(along), bending=magnitude(*e.lam[3:]))
