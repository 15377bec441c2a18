"""Spatial revolute joint."""

from __future__ import annotations

from typing import ClassVar

from ...element import Expr, Symbolic
from ...forces.friction import Loads, magnitude
from ..branches import initially_apart
from ..primitives import ALIGN, COINCIDE, SpatialJoint, align, coincide


class Revolute(SpatialJoint):
    """Hinge: two points coincide, with the z axes of both markers parallel.

    The reaction is a force of any direction, and a torque normal to the axis.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (revolute joint).
    """

    kind = "revolute"
    symmetric_with = {"i": "z", "j": "z"}
    equations = (*COINCIDE, *ALIGN)
    coordinates = ("angle",)
    transmits = ("fx", "fy", "fz", "tx", "ty")
    elastic = "bushing"
    initially: ClassVar = staticmethod(initially_apart)

    def spins_with(self) -> dict[str, str]:
        return {"i": "z", "j": "z"}

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [*coincide(e.i, e.j), *align(e.i, e.j)]

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        """Return the force normal to and along the axis, and the moment normal to it."""
        from sympy import Matrix

        force, z = Matrix(e.lam[:3]), e.j.z
        along = force.dot(z)
        return Loads(across=magnitude(*(force - along * z)), thrust=magnitude(along), bending=magnitude(*e.lam[3:]))
