"""Rack and pinion."""

from __future__ import annotations

from pydantic import Field

from ...reading.joint_name import JointReference
from ...reading.units import si
from ..element import Expr, Matrix, Symbolic
from .relation import Relation


class RackAndPinion(Relation):
    """Pinion that rolls on a rack, both on one housing: s - R theta - offset = 0.

    s is the coordinate of the rack's prismatic joint, theta that of the pinion's revolute joint; both joints have the
    housing (or ground) as marker j. With R > 0 a counter-clockwise rotation of the pinion moves the rack forward along
    its axis, as with the pinion on its left; for a pinion on its right R < 0. Nikravesh, Computer-Aided Analysis of
    Mechanical Systems (1988), section 4.2.3.

    The reaction is the tooth force on the rack, along its axis; on the pinion only its moment acts.
    """

    kind = "rack_and_pinion"
    reflected = {"pitch_radius": "rack pinion", "offset": "rack"}
    equations = ("mesh",)
    wanted = {"rack": "displacement", "pinion": "angle"}
    carried = True

    rack: JointReference = Field(description="prismatic joint of the rack (marker i), on which the force is reported")
    pinion: JointReference = Field(
        description="revolute joint of the pinion (marker i), in the same housing (marker j)"
    )
    pitch_radius: si.LengthNotZero = Field(description="R, m; negative for a pinion on the right of the rack's axis")
    offset: si.Length | None = Field(None, description="s - R theta, m; by default its value in the initial pose")

    @staticmethod
    def relation(e: Symbolic) -> Expr:
        return e.rack.coordinate - e.pitch_radius * e.pinion.coordinate - e.offset

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        return e.rack.i.point
