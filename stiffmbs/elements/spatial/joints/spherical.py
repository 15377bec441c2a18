"""Spherical joint."""

from __future__ import annotations

from collections.abc import Sequence

from ...element import Expr, Symbolic
from ...forces.friction import Loads, magnitude
from ..primitives import COINCIDE, SpatialJoint, coincide


class Spherical(SpatialJoint):
    """Ball joint: a point of body i and a point of body j coincide.

    The reaction is a force of any direction, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (spherical joint).
    """

    kind = "spherical"
    symmetric_with = {"i": "point", "j": "point"}
    equations = COINCIDE
    transmits = ("fx", "fy", "fz")
    elastic = "bushing"

    def spins_with(self) -> dict[str, str]:
        return {"i": "point", "j": "point"}

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        return coincide(e.i, e.j)

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(*e.lam))
