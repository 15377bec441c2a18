"""Spatial fixed joint."""

from __future__ import annotations

from ..primitives import COINCIDE, ORIENT, SpatialJoint


class Fixed(SpatialJoint):
    """Weld: two markers coincide in position and orientation.

    The reaction is a force and a torque of any direction. This is Adams' FIXED.

    The equations of orientation have seven other solutions (half turns and third turns), so markers drawn 60 degrees or
    more apart are refused.
    """

    kind = "fixed"
    known_as = ("weld", "rigid")
    conditions = COINCIDE, ORIENT
    elastic = "bushing"
