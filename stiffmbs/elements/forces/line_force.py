"""Force along the line between two points, in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic

from pydantic import Field

from ...reading.formula.field import ForceOfMotion
from ...reading.marker import M, Marker
from ..element import Expr, Force, Symbolic
from ..initial_pose import InitialPose


class ForceAlongLine(Force, Generic[M]):
    """Base of the planar and the spatial line force."""

    kind = "line_force"
    reflected = {}
    spin_conditions = {"i": "point", "j": "point"}

    i: M = Field(description="marker of the first body, on which the force is reported")
    j: M = Field(description="marker of the second body")
    force: ForceOfMotion = Field(description="force, N, positive if it pushes the points apart: a number or a formula")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        """Yield an error for coincident points, between which the force has no direction."""
        if pose.at_one_place(self.i, self.j):
            yield "found both of its points in the same place, where its force has no direction, expected them apart"

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return the force on the distance of the points."""
        return [(e.force, e.distance(e.i.point, e.j.point))]

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        return -e.force * e.distance(e.i.point, e.j.point) if e.is_constant(e.force) else 0


class LineForce(ForceAlongLine[Marker]):
    """Force along the line between two points: constant, or a formula of any measured quantity.

    A positive force pushes the points apart, as in Adams' translational SFORCE. A constant force has a potential, other
    forces have none.

    Examples
    --------
    A spring-damper of 100 N/m, 2 m and 1 N s/m::

        {type: line_force, i: a, j: b, force: "-100*(dm(a, b) - 2) - vr(a, b)"}
    """
