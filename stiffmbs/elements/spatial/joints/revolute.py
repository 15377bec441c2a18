"""Spatial revolute joint."""

from __future__ import annotations

from ...element import Symbolic, sp
from ...loads import Loads, magnitude
from ..primitives import ALIGN, COINCIDE, SpatialJoint, Turns


class Revolute(SpatialJoint):
    """Hinge: two points coincide, with the z axes of both markers parallel.

    The angle of marker i relative to marker j starts within half a turn, plus `turns`. A position drive on it selects
    the turn nearest to the prescribed angle instead.

    The reaction is a force of any direction, and a torque normal to the axis.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (revolute joint).
    """

    kind = "revolute"
    known_as = ("hinge", "pin")
    spin_conditions = {"i": "z", "j": "z"}
    conditions = COINCIDE, ALIGN
    coordinates = ("angle",)
    elastic = "bushing"

    turns: Turns = None

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        """Return the force normal to and along the axis, and the moment normal to it."""
        force, z = sp.Matrix(e.lam[:3]), e.j.z
        along = force.dot(z)
        return Loads(
            across=magnitude(e, *(force - along * z)), thrust=magnitude(e, along), bending=magnitude(e, *e.lam[3:])
        )
