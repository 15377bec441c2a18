"""A force by formula along the line between two points, in the plane and in space alike."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from pydantic import Field

from ..element import Force, Symbolic
from ..formula.field import ForceOfMotion
from ..marker import Marker, MarkerReference

if TYPE_CHECKING:
    from ..initial_pose import InitialPose

M = TypeVar("M", bound=MarkerReference)


class ForceAlongLine(Force, Generic[M]):
    """The force between points of any markers: those of the plane and of space are made of it."""

    kind: ClassVar[str] = "line_force"
    reflected: ClassVar[dict[str, str] | None] = {}

    i: M = Field(description="marker of the first body, on which the force is reported")
    j: M = Field(description="marker of the second body")
    force: ForceOfMotion = Field(
        description="N, pushing the points apart where it is above zero: a number or a formula"
    )

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        """Points at one place give the force no direction."""
        if pose.at_one_place(self.i, self.j):
            yield "found both of its points at one place, where its force has no direction, expected them apart"

    def spins_with(self) -> dict[str, str]:
        return {"i": "point", "j": "point"}

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        """The force on the distance of the points."""
        return [(e.force, e.distance(e.i.point, e.j.point))]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        return -e.force * e.distance(e.i.point, e.j.point) if e.is_constant(e.force) else 0


class LineForce(ForceAlongLine[Marker]):
    """A force between two points along the line through them: constant, or a formula of anything measured.

    Above zero it pushes the points apart, as Adams' translational SFORCE does.  A constant force has a potential,
    others have none.

    Examples
    --------
    A spring-damper of 100 N/m, 2 m and 1 N s/m::

        {type: line_force, i: a, j: b, force: "-100*(dm(a, b) - 2) - vr(a, b)"}
    """
