"""Spherical joint."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...forces.friction import magnitude
from ...loads import Loads
from ..marker import Marker
from ..primitives import COINCIDE, coincide


class Spherical(Joint):
    """Ball joint: a point of body i and a point of body j coincide.

    The reaction is a force of any direction, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (spherical joint).
    """

    kind: ClassVar[str] = "spherical"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = COINCIDE
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "fz")
    elastic: ClassVar[str] = "bushing"

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    def spins_with(self) -> dict[str, str]:
        return {"i": "point", "j": "point"}

    @staticmethod
    def position(e: Symbolic) -> Any:
        return coincide(e.i, e.j)

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        return Loads(across=magnitude(*e.lam))
