"""Revolute joint."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ...reading.marker import Marker
from ..element import Joint, Symbolic
from ..forces.friction import Loads, magnitude


class Revolute(Joint):
    """Pin: a point of body i and a point of body j coincide.

    The reaction is a force of any direction at the pin, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), eq. 3.3.10.
    """

    kind = "revolute"
    reflected = {}
    equations = ("x", "y")
    coordinates = ("angle",)
    elastic = "bushing"
    keeps_in_plane = True

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    @staticmethod
    def position(e: Symbolic) -> Any:
        return e.i.point - e.j.point

    @staticmethod
    def angle(e: Symbolic) -> Any:
        """Return the angle of marker i relative to marker j."""
        return e.i.angle - e.j.angle

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(*e.lam))
