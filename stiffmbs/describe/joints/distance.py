"""Distance joint: a rigid rod without mass."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..element import Joint, Symbolic
from ..fields import Measured
from ..marker import Marker


class Distance(Joint):
    """Rod: a point of body i and a point of body j keep their distance, (d . d - L^2)/(2 L) = 0.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), eq. 3.3.7, divided by 2 L: the multiplier
    is then the tension of the rod in N, and the equation stays smooth at every distance.  For a distance of zero the
    points coincide: that is a revolute joint.
    """

    kind: ClassVar[str] = "distance"
    equations: ClassVar[tuple[str, ...]] = ("length",)

    type: Literal["distance"] = "distance"
    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")
    length: Annotated[float, Measured("length", above=0)] = Field(description="L, from point to point, m")

    @staticmethod
    def position(e: Symbolic) -> Any:
        d = e.i.point - e.j.point
        return [(d.dot(d) - e.length**2) / (2 * e.length)]
