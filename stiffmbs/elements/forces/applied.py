"""Applied force and torque, constant or by formula."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from ...reading.formula.field import ForceOfMotion, TorqueOfMotion
from ...reading.marker import Marker
from ..element import Expr, Force, Symbolic

if TYPE_CHECKING:
    from ...compile.symbolic.planar_frames import Frame


def force_at(fx: Expr, fy: Expr, i: Frame, j: Frame | None = None) -> list[tuple[Expr, Expr]]:
    """Return the efforts of a force at i's point on i's body, and of the opposite force on j's body at that point."""
    if j is None:
        return [(fx, i.point[0]), (fy, i.point[1])]
    d = i.point - j.point
    return [(fx * axis[0] + fy * axis[1], d.dot(axis)) for axis in (j.axis, j.normal)]


class AppliedForce(Force):
    """Force at a point of a body: constant, or a formula of time and of any measured quantity.

    Its components are along the ground axes, or with ``axes: body`` along the axes of marker i. Bodies that a formula
    only measures receive no force. With `j` a second body receives the opposite force at the same point of space
    (Adams: JFLOAT marker), so linear and angular momentum are conserved.

    A constant force on one body in ground axes has a potential, other forces have none.

    Examples
    --------
    Drag of a ball in air, with parameters rho, cd and area; vm and vx are measured at its centre against ground::

        {type: force, i: ball, force: ["-rho*cd*area/2*vm(ball)*vx(ball)", "-rho*cd*area/2*vm(ball)*vy(ball)"]}

    Together with `AppliedTorque` this is the planar form of GFORCE in Adams.
    """

    kind = "force"
    forms = ({}, {"axes": "body"}, {"j": "b"})
    reflected = {"force": "vector"}

    i: Marker = Field(description="marker at which the force acts")
    j: Marker | None = Field(None, description="a second body, on which the opposite force acts at the same point")
    force: tuple[ForceOfMotion, ForceOfMotion] = Field(description="components along x and y, N: numbers or formulas")
    axes: Literal["ground", "body"] = Field(
        "ground", description="axes x and y of the components: the ground's or marker i's"
    )

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return the components on the point's coordinates in ground axes, or relative to j along j's axes."""
        along, across = e.force
        fx, fy = along * e.i.axis + across * e.i.normal if e.axes == "body" else (along, across)
        return force_at(fx, fy, e.i, e.j)

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        if e.j is not None or e.axes == "body" or not all(e.is_constant(component) for component in e.force):
            return 0
        return -e.force[0] * e.i.point[0] - e.force[1] * e.i.point[1]


class AppliedTorque(Force):
    """Torque on a body: constant, or a formula of time and of any measured quantity.

    With `j` a second body receives the opposite torque. A constant torque has a potential, other torques have none.
    This is the planar form of the rotational SFORCE in Adams.
    """

    kind = "torque"
    forms = ({}, {"j": "b"})
    reflected = {"torque": "angle"}

    i: Marker = Field(description="marker of the body on which the torque acts")
    j: Marker | None = Field(None, description="marker of a second body, on which the opposite torque acts")
    torque: TorqueOfMotion = Field(description="torque about z, N m: a number or a formula")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        return [(e.torque, AppliedTorque.angle(e))]

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        return -e.torque * AppliedTorque.angle(e) if e.is_constant(e.torque) else 0

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        """Return the angle on which the torque does work."""
        return e.i.angle - (e.j.angle if e.j is not None else 0)
