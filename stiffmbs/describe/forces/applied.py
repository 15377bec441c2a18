"""Applied force and torque, constant or by formula."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field

from ..element import Force, Symbolic
from ..formula_field import OfMotion
from ..marker import Marker


class AppliedForce(Force):
    """A force at a point of a body, of time or of anything measured; constant ones have a potential.

    Components are along the ground's axes, or along those of marker `axes` (which takes no reaction: the force is
    an external one).  With `j` the opposite force acts on a second body at its marker.
    """

    kind: ClassVar[str] = "force"

    type: Literal["force"] = "force"
    i: Marker = Field(description="marker at which the force acts")
    j: Marker | None = Field(None, description="marker of a second body on which the opposite force acts")
    force: tuple[OfMotion, OfMotion] = Field(description="components along x and y, N: numbers or formulas")
    axes: Literal["ground", "body"] = Field("ground", description="whether x and y are the ground's or marker i's axes")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        along, across = e.force
        if e.axes == "body":
            fx, fy = along * e.i.axis + across * e.i.normal
        else:
            fx, fy = along, across
        pairs = [(fx, e.i.point[0]), (fy, e.i.point[1])]
        return pairs + ([(-fx, e.j.point[0]), (-fy, e.j.point[1])] if e.j is not None else [])

    @staticmethod
    def potential(e: Symbolic) -> Any:
        if e.axes == "body" or not all(e.is_constant(component) for component in e.force):
            return 0
        arm = e.i.point - e.j.point if e.j is not None else e.i.point
        return -e.force[0] * arm[0] - e.force[1] * arm[1]


class AppliedTorque(Force):
    """A torque on a body, of time or of anything measured, with its opposite on a second body where `j` is given."""

    kind: ClassVar[str] = "torque"

    type: Literal["torque"] = "torque"
    i: Marker = Field(description="marker of the body on which the torque acts")
    j: Marker | None = Field(None, description="marker of a second body on which the opposite torque acts")
    torque: OfMotion = Field(description="about z, N m: a number or a formula")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        return [(e.torque, e.i.angle - (e.j.angle if e.j is not None else 0))]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        if not e.is_constant(e.torque):
            return 0
        return -e.torque * (e.i.angle - (e.j.angle if e.j is not None else 0))
