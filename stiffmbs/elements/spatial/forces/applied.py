"""Spatial applied force and torque, constant or by formula."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ....reading.formula.field import ForceOfMotion, TorqueOfMotion
from ...element import Expr, Force, Matrix, Symbolic, sp
from ..marker import Marker
from ..wrench import Pairs, along_axes, force_at, torque_on


class Applied(Force):
    """Base of spatial applied forces and torques; scenes use its subclasses.

    They act on marker i's body, and the opposite on marker j's. The components are along the axes of the ground, of
    marker i (``axes: body``), or of any marker (`frame`). Bodies that a formula only measures, or that carry `frame`,
    receive no force.
    """

    i: Marker = Field(description="marker of the body on which it acts")
    j: Marker | None = Field(
        None, description="a second body, on which the opposite load acts at the same point of space"
    )
    axes: Literal["ground", "body"] = Field(
        "ground", description="axes x, y and z of the components: the ground's or marker i's"
    )
    frame: Marker | None = Field(None, description="marker along whose axes the components are, in place of `axes`")

    @model_validator(mode="after")
    def _one_kind_of_axes(self) -> Applied:
        if self.frame is not None and self.axes == "body":
            raise ValueError("found both 'frame' and 'axes: body', expected one of them")
        return self

    def spins_with(self) -> dict[str, str]:
        return {} if self.axes == "body" else self.spin_conditions

    @staticmethod
    def vector(e: Symbolic, components: tuple[Expr, ...]) -> Matrix:
        """Return components along the element's axes as a vector in ground axes."""
        marker = e.i if e.axes == "body" else e.frame
        return sp.Matrix(components) if marker is None else along_axes(components, marker.axes)


class AppliedForce(Applied):
    """Force at a point of a body: constant, or a formula of time and of any measured quantity.

    With `j` a second body receives the opposite force at the same point of space (Adams: JFLOAT marker), so linear and
    angular momentum are conserved.

    A constant force on one body in ground axes has a potential, other forces have none.

    This is Adams' VFORCE, together with `AppliedTorque` its GFORCE, and with ``frame: j`` its SFORCE of one body
    (ACTIONONLY); `LineForce` is its SFORCE between two.
    """

    kind = "force"
    spin_conditions = {"i": "point", "j": "body"}
    forms = ({}, {"axes": "body"}, {"j": "b"})
    reflected = {"force": "vector"}

    force: tuple[ForceOfMotion, ForceOfMotion, ForceOfMotion] = Field(
        description="components along x, y and z, N: numbers or formulas"
    )

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the force on the velocity of i's point, relative to j's body there."""
        return force_at(e, cls.vector(e, e.force), e.i, e.j)

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        """Return minus the work of the force from the origin."""
        in_ground = e.axes == "ground" and e.frame is None
        if e.j is not None or not in_ground or not all(e.is_constant(component) for component in e.force):
            return 0
        return -sum(component * x for component, x in zip(e.force, e.i.point, strict=True))


class AppliedTorque(Applied):
    """Torque on a body: constant, or a formula of time and of any measured quantity.

    With `j` a second body receives the opposite torque. A torque in space has no potential, because the work of two
    rotations depends on their order.

    This is Adams' VTORQUE; with ``frame: j`` and only the last component its rotational SFORCE.
    """

    kind = "torque"
    spin_conditions = {"i": "body", "j": "body"}
    forms = ({}, {"j": "b"})
    reflected = {"torque": "rotations"}

    torque: tuple[TorqueOfMotion, TorqueOfMotion, TorqueOfMotion] = Field(
        description="components along x, y and z, N m: numbers or formulas"
    )

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the torque on the angular velocity of i's body, relative to j's."""
        return torque_on(cls.vector(e, e.torque), e.i, e.j)
