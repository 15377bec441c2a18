"""Coupler of two joint coordinates."""

from __future__ import annotations

from pydantic import Field

from ...reading.joint_name import JointReference
from ...reading.units import si
from ..element import Expr, Matrix, Symbolic
from .relation import Relation


class Coupler(Relation):
    """Linear relation between two joint coordinates: s_1 - scale s_2 - offset = 0.

    A coordinate is the angle of a revolute joint, or the displacement of a prismatic or point-on-line joint, of marker
    i relative to marker j. Examples are belts, screws, winches, hydraulic links. This is Adams' COUPLER of two joints.

    The reaction is the generalised force on the first body of joint 1: a torque on an angle, a force along the axis of
    a displacement.
    """

    kind = "coupler"
    reflected = {"scale": "joint_1 joint_2", "offset": "joint_1"}
    equations = ("ratio",)
    forms = ({"joint_1": "pin", "joint_2": "second_pin"}, {"joint_1": "slider", "joint_2": "second_slider"})

    joint_1: JointReference = Field(description="joint with the coordinate s_1")
    joint_2: JointReference = Field(description="joint with the coordinate s_2")
    scale: si.ValueNotZero = Field(description="ds_1/ds_2, in units of s_1 over units of s_2 (m, rad)")
    offset: si.Anything | None = Field(
        None, description="s_1 - scale s_2, m or rad; by default its value in the initial pose"
    )

    @staticmethod
    def relation(e: Symbolic) -> Expr:
        return e.joint_1.coordinate - e.scale * e.joint_2.coordinate - e.offset

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        return e.joint_1.i.point
