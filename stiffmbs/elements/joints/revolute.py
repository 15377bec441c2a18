"""Revolute joint."""

from __future__ import annotations

from ..element import Matrix, Symbolic
from ..loads import Loads, magnitude
from ..turns import KeepsDescribedTurns
from .planar_pair import PlanarPair


class Revolute(KeepsDescribedTurns, PlanarPair):
    """Pin: a point of body i and a point of body j coincide.

    The reaction is a force of any direction at the pin, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), eq. 3.3.10.
    """

    kind = "revolute"
    known_as = ("hinge", "pin")
    equations = ("x", "y")
    coordinates = ("angle",)
    elastic = "bushing"
    keeps_in_plane = True

    @staticmethod
    def position(e: Symbolic) -> Matrix:
        return e.i.point - e.j.point

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(e, *e.lam))
