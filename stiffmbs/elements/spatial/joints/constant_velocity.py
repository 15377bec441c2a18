"""Constant velocity joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal, Self

from pydantic import Field

from ...element import Expr, Symbolic
from ...initial_pose import InitialPose
from ..branches import initially_twisted
from ..marker import Marker
from ..primitives import COINCIDE, SpatialJoint

if TYPE_CHECKING:
    from ....model.model_data import ModelData


class ConstantVelocity(SpatialJoint):
    """Constant velocity joint: two points coincide, and both shafts rotate about their z axes at the same rate.

    One marker is rotated relative to the other about an axis in the plane that bisects their xy planes, without twist:
    i.x . j.y = i.y . j.x for z axes with the same direction when the shafts are in line. For opposite z axes, both away
    from the joint as in Adams' CONVEL, it is i.x . j.y = -i.y . j.x. With the shafts in line the x axes (or the y axes)
    of both markers must be drawn parallel. The joint angle must be less than half a turn.

    The reaction is a force of any direction, and a torque in the bisecting plane.

    Adams/Solver's JOINT statement (CONVEL); Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989),
    section 9.4.
    """

    kind = "constant_velocity"
    equations = (*COINCIDE.rows, "twist")

    i: Marker = Field(description="marker of the first shaft, z along it; the reaction is reported on it")
    j: Marker = Field(description="marker of the second shaft, z along it")
    axes: Literal["same", "opposite"] | None = Field(
        None, description="sense of the axes z when the shafts are in line; by default as described"
    )

    def at_initial_pose(self, model: ModelData) -> Self:
        if self.axes is not None:
            return self
        same = model.initial_marker(self.i).z @ model.initial_marker(self.j).z > 0
        return self.model_copy(update={"axes": "same" if same else "opposite"})

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from initially_twisted(pose, self.i, self.j, self.at_initial_pose(pose.model).axes == "opposite")

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        first, second = e.i.x.dot(e.j.y), e.i.y.dot(e.j.x)
        return [*COINCIDE.residuals(e.i, e.j), first - second if e.axes == "same" else first + second]
