"""Fixed joint."""

from __future__ import annotations

from ..element import Expr, Symbolic
from ..turns import WithinHalfATurn
from .planar_pair import PlanarPair


class Fixed(WithinHalfATurn, PlanarPair):
    """Weld: two markers coincide in position and direction.

    The reaction is a force of any direction and a torque. This is Adams' FIXED in the plane.
    """

    kind = "fixed"
    known_as = ("weld", "rigid")
    equations = ("x", "y", "angle")
    elastic = "bushing"
    keeps_in_plane = True
    same_in_each_pose = True

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        return [*(e.i.point - e.j.point), e.i.angle - e.j.angle]
