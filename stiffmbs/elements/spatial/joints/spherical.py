"""Spherical joint."""

from __future__ import annotations

from ...element import Symbolic
from ...loads import Loads, magnitude
from ..primitives import COINCIDE, SpatialJoint


class Spherical(SpatialJoint):
    """Ball joint: a point of body i and a point of body j coincide.

    The reaction is a force of any direction, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (spherical joint).
    """

    kind = "spherical"
    known_as = ("ball", "ball_joint")
    spin_conditions = {"i": "point", "j": "point"}
    conditions = (COINCIDE,)
    elastic = "bushing"

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(e, *e.lam))
