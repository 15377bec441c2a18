"""Friction in a planar joint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ..element import Symbolic
from .any_joint_friction import PIN, AnyJointFriction
from .friction import Friction


class JointFriction(AnyJointFriction):
    """Dry friction in a revolute or prismatic joint, loaded by the joint's reaction.

    For a pin of radius R the normal force is N = sqrt(lam_x^2 + lam_y^2). The sliding speed is v = R angle', and the
    torque -mu(v) N R acts on the joint's angle. For a slider N = ``|lam_normal| + |lam_angle| / (length/2)``, and the
    force -mu(v) N acts on its displacement. The moment is supported at the ends of a guide of the given length; without
    a length it is neglected. The multipliers are those of the same time, which include the effect of friction.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.5; Adams' FRICTION statement.
    """

    kind: ClassVar[str] = "joint_friction"
    dimensions: ClassVar[tuple[int, ...]] = (2,)
    reflected: ClassVar[dict[str, str] | None] = {}
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"joint": "pin", "friction": 0.1, "radius": 0.01},
        {"joint": "slider", "friction": 0.1},
        {"joint": "slider", "friction": 0.1, "static_friction": 0.2},
    )

    @classmethod
    def known(cls) -> Mapping[str, Any]:
        from ..model import JOINTS

        return JOINTS

    @classmethod
    def efforts(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """Return -mu(v) N, times R for a pin, on the joint's coordinate."""
        coordinate = e.joint.coordinate
        arm = e.radius if e.joint.coordinates == PIN else 1
        v = arm * e.rate(coordinate)
        return [(-Friction.coefficient(e, v) * cls.pressure(e) * arm, coordinate)]

    @classmethod
    def pressure(cls, e: Symbolic) -> Any:
        """Return the normal force N on the sliding surfaces."""
        load = e.joint.loads
        return load.across + (load.bending / (e.length / 2) if e.length is not None else 0)
