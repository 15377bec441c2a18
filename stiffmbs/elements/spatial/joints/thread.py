"""Thread: the equation of a screw."""

from __future__ import annotations

import math
from typing import ClassVar

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Symbolic
from ...joints.relation import OffsetConstraint
from ..marker import Marker
from ..primitives import SpatialJoint


class Thread(OffsetConstraint):
    """Relation of displacement along the z axis of marker j to the angle about it: s - pitch theta/(2 pi) - offset = 0.

    This is Adams' SCREW, a single equation that requires an additional cylindrical joint. A positive pitch is a
    right-handed thread. The reaction is a force along z and a torque about it.

    Shabana, Computational Dynamics (2001), p. 434 (screw joint).
    """

    kind = "thread"
    reflected = {"pitch": "pitch", "offset": "z"}
    equations: ClassVar[tuple[str, ...]] = ("pitch",)

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the thread's")
    pitch: si.LengthNotZero = Field(
        description="advance along z in one revolution, m; negative for a left-handed thread"
    )
    offset: si.Length | None = Field(None, description="s at angle zero, m; by default its value in the initial pose")

    @staticmethod
    def relation(e: Symbolic) -> Expr:
        return SpatialJoint.displacement(e) - e.pitch / (2 * math.pi) * SpatialJoint.angle(e) - e.offset
