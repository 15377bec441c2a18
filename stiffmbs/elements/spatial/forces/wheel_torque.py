"""Torque on a wheel about its axle."""

from __future__ import annotations

from pydantic import Field

from ....reading.formula.field import TorqueOfMotion
from ...element import Expr, Force, Symbolic
from ..marker import Marker
from ..wrench import Pairs


class AxleForce(Force):
    """Base of torques on i's body about i's y axis, and the opposite on j's body; scenes use its subclasses."""

    spin_conditions = {"i": "along y", "j": "body"}

    i: Marker = Field(description="marker on the wheel, its y axis along the axle, to the left of the heading")
    j: Marker = Field(
        description="body on which the opposite torque acts: the upright outboard, the car's body inboard"
    )

    @staticmethod
    def spin(e: Symbolic) -> Expr:
        """Return the angular velocity of the wheel relative to j's body about its axle, rad/s; positive forward."""
        return e.named((e.i.omega - e.j.omega).dot(e.i.y))


class WheelTorque(AxleForce):
    """Torque on a wheel about its axle: constant, or a formula of time and of any measured quantity.

    A positive torque drives forward. The opposite torque acts on the body of j: the upright for an in-wheel motor. For
    drive shafts with constant velocity joints it is the car's body or the carrier of a differential.
    """

    kind = "wheel_torque"
    reflected = {"torque": "about y"}

    torque: TorqueOfMotion = Field(description="torque about the axle, N m: a number or a formula")

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        return [(e.torque, cls.spin(e))]
