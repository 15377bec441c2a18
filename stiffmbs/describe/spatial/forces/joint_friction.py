"""Friction in a joint in space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ...forces.any_joint_friction import BALL, GUIDE, PIN, SLEEVE, AnyJointFriction
from ...units import si
from ..wrench import Pairs, velocity


class JointFriction(AnyJointFriction):
    """Dry friction in a revolute, cylindrical, prismatic or spherical joint, pressed by the joint's own reaction.

    The reaction is a force at i's point, of which F is the part across the axis z and T the thrust along it, and a
    moment, M across the axis and D about it; both from the multipliers of the same instant, friction included.

    - A pin of radius R (``revolute``) slides at R w, w being the angular velocity about the axis, under N = F + M/(length/2)
      (the moment being taken at the ends of a bearing of a given length, not counted without one), and the torque
      -mu N R brakes it.  A collar at `thrust_radius` slides under T; without that the thrust does not rub.
    - A sleeve (``cylindrical``) does so both around and along: the friction mu N is against the velocity of the surface,
      (R w, v), at its magnitude; without a radius it is along the axis alone.
    - A guide (``prismatic``) slides under N = F + M/(length/2) + D/torsion_radius, the last where that is given.
    - A ball of radius R (``spherical``) is braked by a torque mu F R against its angular velocity.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.5; Adams' FRICTION statement.
    """

    kind: ClassVar[str] = "joint_friction"
    dimensions: ClassVar[tuple[int, ...]] = (3,)
    reflected: ClassVar[dict[str, str] | None] = {}
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"joint": "pin", "friction": 0.1, "radius": 0.01},
        {"joint": "slider", "friction": 0.1},
        {"joint": "ball", "friction": 0.1, "radius": 0.01},
        {"joint": "sleeve", "friction": 0.1, "radius": 0.01},
    )

    thrust_radius: si.PositiveLength | None = Field(
        None, description="of a revolute joint's collar, on which its thrust rubs, m"
    )
    torsion_radius: si.PositiveLength | None = Field(
        None, description="at which a prismatic joint's guide takes the moment about its line, m"
    )

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        yield from super().validation_errors(joints)
        joint = joints[self.joint.joint]
        for field, sorts in (("thrust_radius", (PIN,)), ("torsion_radius", (GUIDE,)), ("length", (PIN, SLEEVE, GUIDE))):
            if getattr(self, field) is not None and joint.coordinates not in sorts:
                fits = ", ".join(self.rubbing(*sorts))
                yield field, f"found one for the {joint.kind} joint '{self.joint}', expected none (for {fits} only)"

    @classmethod
    def known(cls) -> Mapping[str, Any]:
        from ..model import JOINTS

        return JOINTS

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Braking forces and torques on the rates of sliding."""
        i, j, R, load = e.joint.i, e.joint.j, e.radius, e.joint.loads
        w = e.named(i.omega - j.omega)
        if e.joint.coordinates == BALL:
            drag = e.named(-cls.per_speed(e, *(R * w)) * load.across * R**2)
            return [(drag * part, part) for part in w]
        along, about = e.named((e.rate(i.point) - velocity(e, j, i.point)).dot(j.z)), e.named(w.dot(j.z))
        pressure = load.across + (load.bending / (e.length / 2) if e.length is not None else 0)
        if e.joint.coordinates == SLEEVE:
            drag = e.named(-cls.per_speed(e, R * about, along) * pressure)
            return [(drag * along, along), (drag * R**2 * about, about)]
        if e.joint.coordinates == GUIDE:
            pressure += load.torsion / e.torsion_radius if e.torsion_radius is not None else 0
            return [(-cls.coefficient(e, along) * pressure, along)]
        braking = -cls.coefficient(e, R * about) * pressure * R
        if e.thrust_radius is not None:
            braking -= cls.coefficient(e, e.thrust_radius * about) * load.thrust * e.thrust_radius
        return [(braking, about)]
