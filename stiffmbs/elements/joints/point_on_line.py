"""Point on a line: a pin in a straight slot."""

from __future__ import annotations

from pydantic import Field

from ...reading.marker import Marker
from ..element import Expr, Symbolic
from ..turns import KeepsDescribedTurns
from .planar_pair import PlanarPair


class PointOnLine(KeepsDescribedTurns, PlanarPair):
    """Pin in a slot: the point of marker i remains on the line through marker j along j's axis, d . n_j = 0.

    Body i can rotate. Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), section 4.2.1 (the first of the
    two equations of a translational joint). The reaction is normal to the line, without friction.
    """

    kind = "point_on_line"
    equations = ("normal",)
    coordinates = ("displacement",)
    further_coordinates = ("angle",)
    elastic = "bushing"

    i: Marker = Field(description="marker of the body with the pin, on which the reaction is reported")
    j: Marker = Field(description="marker whose axis is the line")

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [(e.i.point - e.j.point).dot(e.j.normal)]
