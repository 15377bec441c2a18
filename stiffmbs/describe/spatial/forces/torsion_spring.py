"""Torsion spring-damper in space."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...element import Symbolic
from ...forces.torsion_spring import AngleSpring
from ...initial_pose import InitialPose
from ..branches import initially_without_axis
from ..marker import Marker
from ..primitives import angle_about_z


class TorsionSpring(AngleSpring[Marker]):
    """Rotational spring and damper, linear or by curves, about the axis z that two markers have in common.

    With the angle of marker i against marker j about z, counted over whole turns from within half a turn at the start,
    it has the fields and the law of the plane's torsion spring: the moment
    k s + spring_law(s) + c v + damper_law(v) + preload at s = angle - free_angle and v = angle' turns i back towards j.

    The axes z are kept parallel by a joint, such as a revolute or cylindrical one.  Where they are not quite parallel
    the angle is that of i's x about j's z, and the torque is the one that conserves energy.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 11.2 (RSDA).
    """

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_without_axis(pose.model, self.i, self.j)

    @staticmethod
    def angle(e: Symbolic) -> Any:
        return angle_about_z(e)
