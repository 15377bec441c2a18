"""Base of planar and spatial joint friction, with normal forces from the joint's reaction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import Field

from ..element import Joint, Symbolic
from ..joint_name import JointReference
from ..units import si
from .friction import Friction

PIN, GUIDE, SLEEVE, BALL = ("angle",), ("displacement",), ("displacement", "angle"), ()
"""Categories of joints, by their coordinates."""


class AnyJointFriction(Friction):
    """Base of planar and spatial joint friction; scenes use its subclasses.

    The normal force follows from the multipliers at the same time, which include the effect of friction. The
    coordinates of the joint determine its friction surface: a pin, guide, sleeve or ball.
    """

    joint: JointReference = Field(description="the joint")
    friction: si.NumberOrZero = Field(description="mu_d, coefficient of friction when sliding fast")
    radius: si.LengthOrZero = Field(0.0, description="R of a pin or ball, m")
    length: si.PositiveLength | None = Field(None, description="of a guide or bearing, for its moment, m")

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        joint = joints[self.joint.joint]
        if type(joint).loads is Joint.loads:
            *others, last = self.rubbing()
            expected = f"{', '.join(others)} or {last}"
            yield "joint", f"found '{self.joint}', which is of type {joint.kind}, expected a {expected} joint"
        elif joint.coordinates in (PIN, BALL) and self.radius == 0:
            part = "pin" if joint.coordinates == PIN else "ball"
            yield "radius", f"found none for the {joint.kind} joint '{self.joint}', expected the radius of its {part}"

    @classmethod
    def known(cls) -> Mapping[str, Any]:
        """Return the joints of its family, by kind."""
        raise NotImplementedError

    @classmethod
    def rubbing(cls, *sorts: tuple[str, ...]) -> list[str]:
        """Return the kinds of joints that can have friction, optionally of some categories only."""
        return [
            kind
            for kind, joint in cls.known().items()
            if joint.loads is not Joint.loads and (not sorts or joint.coordinates in sorts)
        ]

    @staticmethod
    def point(e: Symbolic) -> Any:
        return e.joint.i.point
