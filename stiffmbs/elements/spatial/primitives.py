"""Primitive equations of spatial joints, with the names of their rows, and the base of these joints.

i and j are markers: `point`, and unit axes `x`, `y`, `z`, all in ground axes. Haug, Computer Aided Kinematics and
Dynamics of Mechanical Systems (1989), section 9.4; Nikravesh (1988), section 7.2.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from ..element import Expr, Matrix, Symbolic
from ..initial_pose import InitialPose
from ..joints.pair import Pair
from .marker import Marker

if TYPE_CHECKING:
    from ...compile.symbolic.spatial_frames import SpatialFrame
    from ...model.model_data import ModelData

COINCIDE = ("x", "y", "z")
"""Rows of `coincide`, along the ground axes."""
ACROSS = ("z_across_z",)
"""Row of `perpendicular` for the z axes."""
ALIGN = ("x_across_z", "y_across_z")
"""Rows of `align`: marker i's x and y are perpendicular to marker j's z."""
ORIENT = ("x_across_y", "y_across_z", "z_across_x")
"""Rows of `orient`: marker i's x is perpendicular to marker j's y, and so on."""
IN_PLANE = ("along_z",)
"""Row of `along` for the z axis of marker j."""
ON_AXIS = ("along_x", "along_y")
"""Rows of `on_axis`, along the x and y axes of marker j."""


def coincide(i: SpatialFrame, j: SpatialFrame) -> list[Expr]:
    """Return the residuals of coincident points."""
    return list(i.point - j.point)


def perpendicular(a: Matrix, b: Matrix) -> Expr:
    """Return the residual of perpendicular vectors."""
    return a.dot(b)


def along(i: SpatialFrame, j: SpatialFrame, axis: Matrix) -> Expr:
    """Return the displacement of i's point from j's along a unit vector."""
    return (i.point - j.point).dot(axis)


def align(i: SpatialFrame, j: SpatialFrame) -> list[Expr]:
    """Return the residuals of parallel z axes, with the same or opposite direction as at the start."""
    return [perpendicular(i.x, j.z), perpendicular(i.y, j.z)]


def orient(i: SpatialFrame, j: SpatialFrame) -> list[Expr]:
    """Return the residuals of parallel axes, which also vanish for half turns about an axis and cyclic permutations."""
    return [perpendicular(i.x, j.y), perpendicular(i.y, j.z), perpendicular(i.z, j.x)]


def on_axis(i: SpatialFrame, j: SpatialFrame) -> list[Expr]:
    """Return the residuals of i's point on the z axis of j."""
    return [along(i, j, j.x), along(i, j, j.y)]


class SpatialJoint(Pair[Marker]):
    """Base of the spatial joints between two markers; a subclass names its coordinates among these."""

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        """Return the angle of marker i relative to marker j about their common z axis, with full revolutions."""
        return e.angle(e.i.x.dot(e.j.y), e.i.x.dot(e.j.x))

    @staticmethod
    def displacement(e: Symbolic) -> Expr:
        """Return the displacement of marker i along the z axis of marker j."""
        return along(e.i, e.j, e.j.z)

    displacement_z: ClassVar = displacement

    @staticmethod
    def displacement_x(e: Symbolic) -> Expr:
        """Return the displacement of marker i along the x axis of marker j."""
        return along(e.i, e.j, e.j.x)

    @staticmethod
    def displacement_y(e: Symbolic) -> Expr:
        """Return the displacement of marker i along the y axis of marker j."""
        return along(e.i, e.j, e.j.y)

    @staticmethod
    def initially(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
        """Yield reasons why the initial pose is too far from the intended solution (`stiffmbs.elements.spatial.branches`)."""
        yield from ()

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        yield from self.initially(pose.model, self.i, self.j)
