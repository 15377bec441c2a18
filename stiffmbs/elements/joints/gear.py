"""Gear pair."""

from __future__ import annotations

from pydantic import Field

from ...reading.joint_name import JointReference
from ...reading.units import si
from ..element import Expr, Matrix, Symbolic
from .relation import Relation


class Gear(Relation):
    """Gear pair with both wheels on one carrier: theta_1 + ratio theta_2 - offset = 0.

    theta_1 and theta_2 are the coordinates of two revolute joints, which have the wheels as marker i and the carrier
    (an arm, or ground) as marker j. `ratio` is teeth_2/teeth_1, or radius_2/radius_1: positive for external teeth,
    where the wheels turn in opposite directions, negative for a pinion in an internal gear. Nikravesh, Computer-Aided
    Analysis of Mechanical Systems (1988), section 4.2.3, in angles instead of arcs, so full turns count.

    The reaction is the torque of the mesh on wheel 1. The force between the teeth is not in the equation, so the pins
    do not carry it.
    """

    kind = "gear"
    reflected = {"offset": "joint_1"}
    equations = ("mesh",)
    wanted = {"joint_1": "angle", "joint_2": "angle"}
    carried = True

    joint_1: JointReference = Field(description="revolute joint of wheel 1 (marker i), on which the torque is reported")
    joint_2: JointReference = Field(description="revolute joint of wheel 2 (marker i), in the same carrier (marker j)")
    ratio: si.NumberNotZero = Field(description="teeth of wheel 2 over teeth of wheel 1, negative for internal teeth")
    offset: si.Angle | None = Field(
        None, description="theta_1 + ratio theta_2, rad; by default its value in the initial pose"
    )

    @staticmethod
    def relation(e: Symbolic) -> Expr:
        return e.joint_1.coordinate + e.ratio * e.joint_2.coordinate - e.offset

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        return e.joint_1.i.point
