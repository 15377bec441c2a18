"""Primitive equations that joints in space are made of, each with the names of its rows.

i and j are markers: `point`, and unit axes `x`, `y`, `z`, all in ground axes.  Haug, Computer Aided Kinematics and
Dynamics of Mechanical Systems (1989), section 9.4; Nikravesh (1988), section 7.2.
"""

from __future__ import annotations

from typing import Any

COINCIDE = ("x", "y", "z")
"""Rows of `coincide`: along the ground's axes."""
ACROSS = ("z_across_z",)
"""Row of `perpendicular`, of the axes z."""
ALIGN = ("x_across_z", "y_across_z")
"""Rows of `align`: marker i's x and y are at right angles to marker j's z."""
ORIENT = ("x_across_y", "y_across_z", "z_across_x")
"""Rows of `orient`: marker i's x at right angles to marker j's y, and so on."""
IN_PLANE = ("along_z",)
"""Row of `along`, along the axis z of marker j."""
ON_AXIS = ("along_x", "along_y")
"""Rows of `on_axis`: along the axes x and y of marker j."""


def coincide(i: Any, j: Any) -> list[Any]:
    """Two points are one."""
    return list(i.point - j.point)


def perpendicular(a: Any, b: Any) -> Any:
    """Two unit vectors are at right angles."""
    return a.dot(b)


def along(i: Any, j: Any, axis: Any) -> Any:
    """How far i's point is from j's along a unit vector; zero where i's point is in the plane across it."""
    return (i.point - j.point).dot(axis)


def align(i: Any, j: Any) -> list[Any]:
    """The axes z are parallel, in the same sense or opposite, as they start."""
    return [perpendicular(i.x, j.z), perpendicular(i.y, j.z)]


def orient(i: Any, j: Any) -> list[Any]:
    """All axes are parallel; satisfied also by half turns about an axis and by a change of the axes' names."""
    return [perpendicular(i.x, j.y), perpendicular(i.y, j.z), perpendicular(i.z, j.x)]


def on_axis(i: Any, j: Any) -> list[Any]:
    """The point of i is on the z axis of j."""
    return [along(i, j, j.x), along(i, j, j.y)]


def angle_about_z(e: Any) -> Any:
    """The angle of marker i against marker j about their common axis z, whole turns counted."""
    return e.angle(e.i.x.dot(e.j.y), e.i.x.dot(e.j.x))
