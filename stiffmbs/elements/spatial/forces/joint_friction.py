"""Friction in a spatial joint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from ....reading.units import si
from ...element import Joint, Symbolic
from ...forces.joint_friction import BALL, GUIDE, PIN, SLEEVE, AnyJointFriction
from ..wrench import Pairs, velocity


class JointFriction(AnyJointFriction):
    """Dry friction in a revolute, cylindrical, prismatic or spherical joint, loaded by the joint's reaction.

    The reaction at i's point, the middle of the supporting part, has the forces F normal to the z axis and T (thrust)
    along it. Its moments are M normal to the axis and D about it. They follow from the multipliers at the same time, which include the effect of friction.

    - Pin of radius R (``revolute``): N = F + M/(length/2), the sliding speed is R w with the angular velocity w about
      the axis, and the torque -mu N R acts on it. The moment is supported at the ends of a bearing of the given length;
      without a length it is neglected. A collar at `thrust_radius` slides under T; without it T has no effect.
    - Sleeve (``cylindrical``): as a pin, but the friction mu N is opposite to the velocity of the surface, (R w, v);
      without a radius it acts along the axis only.
    - Guide (``prismatic``): N = F + M/(length/2) + D/torsion_radius, the last term if the radius is given.
    - Ball of radius R (``spherical``): a torque mu F R opposite to its angular velocity.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.5; Adams' FRICTION statement.
    """

    kind = "joint_friction"
    dimensions: ClassVar[tuple[Literal[3]]] = (3,)
    reflected = {}
    forms = (
        {"joint": "pin", "radius": ...},
        {"joint": "slider"},
        {"joint": "ball", "radius": ...},
        {"joint": "sleeve", "radius": ...},
    )

    thrust_radius: si.PositiveLength | None = Field(
        None, description="radius of the collar of a revolute joint, for the friction of its thrust, m"
    )
    torsion_radius: si.PositiveLength | None = Field(
        None, description="radius at which the guide of a prismatic joint carries the moment about its line, m"
    )

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield unsuitable joints, and lengths and radii that the joint does not have."""
        yield from super().validation_errors(joints)
        joint = joints[self.joint.joint]
        for field, sorts in (("thrust_radius", (PIN,)), ("torsion_radius", (GUIDE,)), ("length", (PIN, SLEEVE, GUIDE))):
            if getattr(self, field) is not None and joint.coordinates not in sorts:
                fits = ", ".join(self.frictional_kinds(*sorts))
                yield field, f"found one for the {joint.kind} joint '{self.joint}', expected none (for {fits} only)"

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the friction of the pin, guide, sleeve or ball, with the rates of its motion."""
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
