"""A tyre that only carries."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...units import si
from ..tyre import Rolling, Tyre


class VerticalTyre(Tyre):
    """A spring and damper between a wheel and a road, which lifts off; it transmits no force along the road.

    load = max(0, stiffness d + damping d') where the deflection d = radius - (loaded radius) is above zero.
    """

    kind: ClassVar[str] = "vertical_tyre"

    radius: si.PositiveLength = Field(description="without load, m")
    stiffness: si.Stiffness = Field(description="radial, N/m")
    damping: si.Damping = Field(0.0, description="radial, N s/m")

    @staticmethod
    def law(e: Symbolic, rolling: Rolling) -> tuple[Any, Any, Any, Any, Any]:
        return 0, 0, 0, 0, 0
