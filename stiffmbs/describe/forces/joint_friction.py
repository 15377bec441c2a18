"""Friction in a joint of the plane."""

from __future__ import annotations

from typing import Any, ClassVar

from ..element import Symbolic
from .any_joint_friction import RubbingJoint
from .friction import Friction, magnitude


class JointFriction(RubbingJoint):
    """Dry friction in a revolute or prismatic joint, pressed by the joint's own reaction.

    A pin of radius R is pressed by N = sqrt(lam_x^2 + lam_y^2), its surface slides at v = R angle', and the torque
    -mu(v) N R brakes the joint's angle.  A slider is pressed by ``N = |lam_normal| + |lam_angle| / (length/2)``, the
    moment being taken at the ends of a guide of a given length (not counted without one), and the force -mu(v) N
    brakes its displacement.  The multipliers of the joint are those of the same instant, friction included.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.5; Adams' FRICTION statement.
    """

    kind: ClassVar[str] = "joint_friction"
    reflected: ClassVar[dict[str, str] | None] = {}
    rubbing: ClassVar[tuple[str, ...]] = ("revolute", "prismatic")
    round: ClassVar[tuple[str, ...]] = ("revolute",)

    @classmethod
    def efforts(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """-mu(v) N, times R at a pin, on the joint's coordinate."""
        coordinate = e.joint.coordinate
        arm = e.radius if e.joint.kind == "revolute" else 1
        v = arm * e.rate(coordinate)
        return [(-Friction.coefficient(e, v) * cls.pressure(e) * arm, coordinate)]

    @classmethod
    def pressure(cls, e: Symbolic) -> Any:
        """N, the force that presses the rubbing surfaces."""
        if e.joint.kind == "revolute":
            return magnitude(*e.joint.lam)
        normal, moment = e.joint.lam
        return magnitude(normal) + (magnitude(moment) / (e.length / 2) if e.length is not None else 0)
