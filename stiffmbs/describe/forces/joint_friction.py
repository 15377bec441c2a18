"""Friction in a joint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field

from .. import si
from ..element import Joint, JointReference, Symbolic
from .friction import Friction

TINY = 1e-18
"""N^2, added under the root of a reaction, so that its derivative exists where the reaction vanishes."""


class JointFriction(Friction):
    """Dry friction in a revolute or prismatic joint, pressed by the joint's own reaction.

    A pin of radius R is pressed by N = sqrt(lam_x^2 + lam_y^2), its surface slides at v = R angle', and the torque
    -mu(v) N R brakes the joint's angle.  A slider is pressed by N = |lam_normal| + |lam_angle| / (length/2), the
    moment being taken at the ends of a guide of a given length (not counted without one), and the force -mu(v) N
    brakes its displacement.  The multipliers of the joint are those of the same instant, friction included.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.5; Adams' FRICTION statement.
    """

    kind: ClassVar[str] = "joint_friction"

    type: Literal["joint_friction"] = "joint_friction"
    joint: JointReference = Field(description="the revolute or prismatic joint")
    friction: si.NumberOrZero = Field(description="mu_d, coefficient of friction when sliding fast")
    radius: si.LengthOrZero = Field(0.0, description="R of a revolute joint's pin, m")
    length: si.PositiveLength | None = Field(None, description="of a prismatic joint's guide, for its moment, m")

    def refused(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        kind = joints[self.joint].kind
        if kind not in ("revolute", "prismatic"):
            yield "joint", f"found '{self.joint}', which is of type {kind}, expected a revolute or prismatic joint"
        if kind == "revolute" and self.radius == 0:
            yield "radius", f"found none for the revolute joint '{self.joint}', expected the radius of its pin"

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        """-mu(v) N, times R at a pin, on the joint's coordinate."""
        coordinate = e.joint.coordinate
        arm = e.radius if e.joint.kind == "revolute" else 1
        v = arm * e.rate(coordinate)
        return [(-Friction.coefficient(e, v) * JointFriction.pressure(e) * arm, coordinate)]

    @staticmethod
    def pressure(e: Symbolic) -> Any:
        """N, the force that presses the rubbing surfaces."""
        if e.joint.kind == "revolute":
            return _magnitude(*e.joint.lam)
        normal, moment = e.joint.lam
        return _magnitude(normal) + (_magnitude(moment) / (e.length / 2) if e.length is not None else 0)

    @staticmethod
    def point(e: Symbolic) -> Any:
        return e.joint.i.point


def _magnitude(*parts: Any) -> Any:
    from sympy import sqrt

    return sqrt(sum(part**2 for part in parts) + TINY)
