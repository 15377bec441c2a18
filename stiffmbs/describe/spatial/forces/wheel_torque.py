"""Torque on a wheel about its axle."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from ...element import Symbolic
from ...formula.field import TorqueOfMotion
from ..axle_force import AxleForce
from ..wrench import Pairs


class WheelTorque(AxleForce):
    """Torque on a wheel about its axle: constant, or a formula of time and of any measured quantity.

    A positive torque drives forward. The opposite torque acts on the body of j: the upright for an in-wheel motor. For
    drive shafts with constant velocity joints it is the car's body or the carrier of a differential.
    """

    kind: ClassVar[str] = "wheel_torque"
    reflected: ClassVar[dict[str, str] | None] = {"torque": "about y"}

    torque: TorqueOfMotion = Field(description="N m: a number or a formula")

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        return [(e.torque, cls.spin(e))]
