"""Friction in a planar joint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from ...reading.joint_name import JointReference
from ...reading.units import si
from ..element import Expr, Joint, Matrix, Symbolic
from ..own_elements import kinds_of
from .friction import Friction

PIN, GUIDE, SLEEVE, BALL = ("angle",), ("displacement",), ("displacement", "angle"), ()
"""Categories of joints, by their coordinates."""


class AnyJointFriction(Friction):
    """Base of planar and spatial joint friction; scenes use its subclasses.

    The normal force follows from the multipliers at the same time, which include the effect of friction. The
    coordinates of the joint determine its friction surface: a pin, guide, sleeve or ball.
    """

    joint: JointReference = Field(description="the joint")
    friction: si.NumberOrZero = Field(description="mu_d, dynamic coefficient of friction")
    radius: si.LengthOrZero = Field(0.0, description="R of a pin or ball, m")
    length: si.PositiveLength | None = Field(None, description="length of a guide or bearing, for its moment, m")

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield a joint whose loads are unknown, and a pin or ball without a radius."""
        joint = joints[self.joint.joint]
        if type(joint).loads is Joint.loads:
            *others, last = self.frictional_kinds()
            expected = f"{', '.join(others)} or {last}"
            yield "joint", f"found '{self.joint}', which is of type {joint.kind}, expected a {expected} joint"
        elif joint.coordinates in (PIN, BALL) and self.radius == 0:
            part = "pin" if joint.coordinates == PIN else "ball"
            yield "radius", f"found none for the {joint.kind} joint '{self.joint}', expected the radius of its {part}"

    @classmethod
    def frictional_kinds(cls, *sorts: tuple[str, ...]) -> list[str]:
        """Return the kinds of joints that can have friction, optionally of some categories only."""
        return [
            kind
            for kind, joint in kinds_of(cls.dimensions[0], Joint).items()
            if joint.loads is not Joint.loads and (not sorts or joint.coordinates in sorts)
        ]

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        return e.joint.i.point


class JointFriction(AnyJointFriction):
    """Dry friction in a revolute or prismatic joint, loaded by the joint's reaction.

    For a pin of radius R the normal force is N = sqrt(lam_x^2 + lam_y^2). The sliding speed is v = R angle', and the
    torque -mu(v) N R acts on the joint's angle. For a slider N = ``|lam_normal| + |lam_angle| / (length/2)``, and the
    force -mu(v) N acts on its displacement. The moment lam_angle is that about the point of marker i. It is supported at the
    ends of a guide of the given length, which moves with marker i; without a length it is neglected. With i and j
    exchanged the guide belongs to the other body, and its moment differs by lam_normal times the displacement. The multipliers are those of the same time, which include the effect of friction.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.5; Adams' FRICTION statement.
    """

    kind = "joint_friction"
    dimensions: ClassVar[tuple[Literal[2]]] = (2,)
    reflected = {}
    forms = (
        {"joint": "pin", "radius": ...},
        {"joint": "slider"},
        {"joint": "slider", "friction": 0.1, "static_friction": 0.2},
    )

    @classmethod
    def efforts(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return -mu(v) N, times R for a pin, on the joint's coordinate."""
        coordinate = e.joint.coordinate
        arm = e.radius if e.joint.coordinates == PIN else 1
        v = arm * e.rate(coordinate)
        return [(-Friction.coefficient(e, v) * cls.pressure(e) * arm, coordinate)]

    @classmethod
    def pressure(cls, e: Symbolic) -> Expr:
        """Return the normal force N on the sliding surfaces."""
        load = e.joint.loads
        return load.across + (load.bending / (e.length / 2) if e.length is not None else 0)
