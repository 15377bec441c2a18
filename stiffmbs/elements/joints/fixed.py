"""Fixed joint."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ...reading.marker import InOneTurn, Marker
from ..element import Joint, Symbolic


class Fixed(InOneTurn, Joint):
    """Weld: two markers coincide in position and direction.

    The reaction is a force of any direction and a torque. This is Adams' FIXED in the plane.
    """

    kind = "fixed"
    reflected = {}
    equations = ("x", "y", "angle")
    elastic = "bushing"
    keeps_in_plane = True

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*(e.i.point - e.j.point), e.i.angle - e.j.angle]
