"""Tyre with a vertical force only."""

from __future__ import annotations

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Symbolic
from ..tyre import Rolling, Tyre


class VerticalTyre(Tyre):
    """Spring and damper between a wheel and a road, with lift-off and without forces along the road.

    load = max(0, stiffness d + damping d') where the deflection d = radius - (loaded radius) is positive.
    """

    kind = "vertical_tyre"

    radius: si.PositiveLength = Field(description="unloaded radius, m")
    stiffness: si.Stiffness = Field(description="radial stiffness, N/m")
    damping: si.Damping = Field(0.0, description="radial damping, N s/m")

    @staticmethod
    def law(e: Symbolic, rolling: Rolling) -> tuple[Expr, Expr, Expr, Expr, Expr]:
        return 0, 0, 0, 0, 0
