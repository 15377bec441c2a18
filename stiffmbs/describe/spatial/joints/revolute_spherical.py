"""Rod with a revolute and a spherical end."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...joints.distance import Rod
from ..marker import Marker
from ..primitives import IN_PLANE, along


class RevoluteSpherical(Rod[Marker]):
    """Rod without mass, hinged at marker j and ending in a ball at marker i.

    The point of marker i stays at a distance L from the point of marker j, and in the plane across j's z axis, the
    axis of the hinge: d . z_j = 0 and (d . d - L^2)/(2 L) = 0.  The reaction is a force on the ball, without torque.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4
    (revolute-spherical composite joint).
    """

    kind: ClassVar[str] = "revolute_spherical"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = (*Rod.equations, *IN_PLANE)

    i: Marker = Field(description="marker of the body with the ball, on which the reaction is reported")
    j: Marker = Field(description="marker whose z axis is the hinge's")

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*Rod.position(e), along(e.i, e.j, e.j.z)]
