"""Spatial fixed joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from ...element import Expr, Symbolic
from ..branches import initially_rotated
from ..primitives import COINCIDE, ORIENT, SpatialJoint, coincide, orient


class Fixed(SpatialJoint):
    """Weld: two markers coincide in position and orientation.

    The reaction is a force and a torque of any direction. This is Adams' FIXED.

    The equations of orientation have seven other solutions (half turns and third turns), so markers drawn 60 degrees or
    more apart are refused.
    """

    kind = "fixed"
    symmetric_with = {"i": "body", "j": "body"}
    equations = (*COINCIDE, *ORIENT)
    transmits = ("fx", "fy", "fz", "tx", "ty", "tz")
    elastic = "bushing"
    initially: ClassVar = staticmethod(initially_rotated)

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        return [*coincide(e.i, e.j), *orient(e.i, e.j)]
