"""Fixed joint."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ..element import Joint, Symbolic
from ..marker import InOneTurn, Marker


class Fixed(InOneTurn, Joint):
    """Weld: two markers coincide in position and direction.

    The reaction is a force of any direction and a torque. This is Adams' FIXED in the plane.
    """

    kind: ClassVar[str] = "fixed"
    reflected: ClassVar[dict[str, str] | None] = {}
    equations: ClassVar[tuple[str, ...]] = ("x", "y", "angle")
    elastic: ClassVar[str] = "bushing"
    keeps_in_plane: ClassVar[bool] = True

    i: Marker = Field(description="marker of the first body, on which the reaction is reported")
    j: Marker = Field(description="marker of the second body")

    @staticmethod
    def position(e: Symbolic) -> Any:
        return [*(e.i.point - e.j.point), e.i.angle - e.j.angle]
