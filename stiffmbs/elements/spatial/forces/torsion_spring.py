"""Spatial torsion spring-damper."""

from __future__ import annotations

from collections.abc import Iterator

from ...element import Expr, Symbolic
from ...forces.springs import AngleSpring
from ...initial_pose import InitialPose
from ..branches import initially_without_axis
from ..marker import Marker
from ..primitives import SpatialJoint


class TorsionSpring(AngleSpring[Marker]):
    """Rotational spring and damper about the common z axis of two markers, linear or nonlinear.

    Fields and law are those of the planar torsion spring. The restoring moment on i is k s + spring_law(s) + c v +
    damper_law(v) + preload at s = angle - free_angle and v = angle'. The angle of marker i relative to marker j about z
    includes full revolutions; it is within half a turn at the start.

    A joint must keep the z axes parallel, such as a revolute or cylindrical one. If they are not exactly parallel the
    angle is that of i's x about j's z, and the torque is the one that conserves energy.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 11.2 (RSDA).
    """

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_without_axis(pose, self.i, self.j)

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        return SpatialJoint.angle(e)
