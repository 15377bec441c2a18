"""Distance joint: a rigid massless rod, in the plane and in space."""

from __future__ import annotations

from typing import ClassVar, Generic

from pydantic import Field

from ...reading.marker import M, Marker
from ...reading.units import si
from ..element import Expr, Symbolic
from .pair import Pair


class Rod(Pair[M], Generic[M]):
    """Base of the planar and the spatial distance joint."""

    kind = "distance"
    spin_conditions = {"i": "point", "j": "point"}
    equations: ClassVar[tuple[str, ...]] = ("length",)

    length: si.PositiveLength = Field(description="L, from point to point, m")

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        d = e.i.point - e.j.point
        return [(d.dot(d) - e.length**2) / (2 * e.length)]


class Distance(Rod[Marker]):
    """Rod with constant distance between a point of body i and a point of body j, (d . d - L^2)/(2 L) = 0.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), eq. 3.3.7, divided by 2 L. The multiplier
    is then the tension of the rod in N, and the equation is smooth at every distance. For coincident points use a
    revolute joint.

    The reaction is a force along the rod, from point to point.
    """

    elastic = "spring_damper"
