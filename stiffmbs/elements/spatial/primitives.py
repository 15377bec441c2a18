"""Primitive equations of spatial joints, with the names of their rows, and the base of these joints.

i and j are markers: `point`, and unit axes `x`, `y`, `z`, all in ground axes. Haug, Computer Aided Kinematics and
Dynamics of Mechanical Systems (1989), section 9.4; Nikravesh (1988), section 7.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field

from ..element import Expr, Matrix, Symbolic
from ..initial_pose import InitialPose
from ..joints.pair import Pair
from .branches import initially_aligned, initially_apart, initially_rotated
from .marker import Marker

if TYPE_CHECKING:
    from ...compile.symbolic.spatial_frames import SpatialFrame


def perpendicular(a: Matrix, b: Matrix) -> Expr:
    """Return the residual of perpendicular vectors."""
    return a.dot(b)


def along(i: SpatialFrame, j: SpatialFrame, axis: Matrix) -> Expr:
    """Return the displacement of i's point from j's along a unit vector."""
    return (i.point - j.point).dot(axis)


@dataclass(frozen=True)
class Condition:
    """Condition between two markers, with a name for each of its equations."""

    rows: tuple[str, ...]
    residuals: Callable[[SpatialFrame, SpatialFrame], list[Expr]]
    transmits: tuple[str, ...] = ()  # components of its reaction (`Joint.transmits`)
    # yields reasons why markers are drawn too far from the intended one of several solutions
    initially: Callable[[InitialPose, Marker, Marker], Iterator[str]] = lambda pose, i, j: iter(())


COINCIDE = Condition(("x", "y", "z"), lambda i, j: list(i.point - j.point), ("fx", "fy", "fz"))
"""Coincident points; rows along the ground axes."""
ON_AXIS = Condition(("along_x", "along_y"), lambda i, j: [along(i, j, j.x), along(i, j, j.y)], ("fx", "fy"))
"""Point of i on the z axis of j; rows along the x and y axes of j."""
IN_PLANE = Condition(("along_z",), lambda i, j: [along(i, j, j.z)], ("fz",))
"""Point of i in the xy plane of j."""
ACROSS = Condition(("z_across_z",), lambda i, j: [perpendicular(i.z, j.z)], (), initially_aligned)
"""Perpendicular z axes."""
ALIGN = Condition(
    ("x_across_z", "y_across_z"), lambda i, j: [perpendicular(i.x, j.z), perpendicular(i.y, j.z)], ("tx", "ty"), initially_apart
)  # fmt: skip
"""Parallel z axes, with the same or opposite direction as at the start."""
ORIENT = Condition(
    ("x_across_y", "y_across_z", "z_across_x"),
    lambda i, j: [perpendicular(i.x, j.y), perpendicular(i.y, j.z), perpendicular(i.z, j.x)],
    ("tx", "ty", "tz"),
    initially_rotated,
)
"""Parallel axes; half turns about an axis and cyclic permutations satisfy the equations, too."""

Turns = Annotated[int | None, Field(description="full turns added to the angle within half a turn at the start")]


class SpatialJoint(Pair[Marker]):
    """Base of the spatial joints between two markers; a subclass names its coordinates among these.

    Its `conditions` give its equations, the components that it transmits, and the check of its initial pose.
    """

    conditions: ClassVar[tuple[Condition, ...]] = ()
    written_as: ClassVar[dict[str, str]] = Pair.written_as | dict.fromkeys(
        ("axis", "direction"), "the axis as z of the markers, such as j: {body: ground, orientation: {z: [0, 1, 0]}}"
    )

    @classmethod
    def __pydantic_init_subclass__(cls, **options: object) -> None:
        """Name the equations and the transmitted components of a new kind by its conditions."""
        super().__pydantic_init_subclass__(**options)
        if "conditions" in vars(cls):
            cls.equations = tuple(row for condition in cls.conditions for row in condition.rows)
            cls.transmits = tuple(part for condition in cls.conditions for part in condition.transmits)

    @classmethod
    def position(cls, e: Symbolic) -> list[Expr]:
        return [residual for condition in cls.conditions for residual in condition.residuals(e.i, e.j)]

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

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        for condition in self.conditions:
            yield from condition.initially(pose, self.i, self.j)
