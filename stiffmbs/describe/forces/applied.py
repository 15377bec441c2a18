"""Constant force and torque."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field

from .. import si
from ..element import Force, Symbolic
from ..marker import Marker


class AppliedForce(Force):
    """A constant force in ground axes at a point of a body."""

    kind: ClassVar[str] = "force"

    type: Literal["force"] = "force"
    i: Marker = Field(description="marker at which the force acts")
    force: tuple[si.Force, si.Force] = Field(description="components along the ground's x and y, N")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        return list(zip(e.force, e.i.point, strict=True))

    @staticmethod
    def potential(e: Symbolic) -> Any:
        return -e.force[0] * e.i.point[0] - e.force[1] * e.i.point[1]


class AppliedTorque(Force):
    """A constant torque on a body."""

    kind: ClassVar[str] = "torque"

    type: Literal["torque"] = "torque"
    i: Marker = Field(description="marker of the body on which the torque acts")
    torque: si.Torque = Field(description="about the ground's z, N m")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        return [(e.torque, e.i.angle)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        return -e.torque * e.i.angle
