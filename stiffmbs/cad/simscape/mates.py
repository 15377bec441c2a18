"""Joints of a scene from the constraints and joints of a file.

A constraint between two shapes becomes the joint with the same equations: coincident planes a planar joint, lines on one
axis a cylindrical one. Angles and distances keep their values in the drawn pose. Redundant equations are kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ...reading.files.xml_nodes import Node
from ..assembly import PARALLEL, Frame, Seat, Tie, at_angle, off_axis
from .ends import CIRCLE, LINE, PLANE, POINT, End, Ends

Made = tuple[str, str, End, End]
"""Suffix of a name, kind of a joint, and its ends i and j."""


class Left(Exception):
    """Constraint without an equivalent in a scene; the message is the reason."""


JOINTS = {
    "Weld": "fixed", "Revolute": "revolute", "Prismatic": "prismatic", "Cylindrical": "cylindrical", "Spherical": "spherical",
    "Planar": "planar",
}  # fmt: skip
PIN_SLOT = "PinSlot"
X_AS_Z = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Axes with z along the x axis of the axes they are given in."""
COINCIDENT: dict[tuple[str, str], tuple[str, ...]] = {
    (POINT, POINT): ("spherical",), (POINT, LINE): ("point_on_line",), (POINT, PLANE): ("point_on_plane",),
    (LINE, LINE): ("cylindrical",), (LINE, PLANE): ("point_on_plane", "perpendicular"), (PLANE, PLANE): ("planar",),
    (CIRCLE, PLANE): ("planar",), (CIRCLE, CIRCLE): ("revolute",),
}  # fmt: skip
CONCENTRIC: dict[tuple[str, str], tuple[str, ...]] = {
    **dict.fromkeys([(LINE, LINE), (CIRCLE, LINE), (CIRCLE, CIRCLE)], ("cylindrical",)),
    (POINT, LINE): ("point_on_line",), (POINT, CIRCLE): ("point_on_line",), (POINT, POINT): ("spherical",),
}  # fmt: skip
PARALLEL_TO: dict[tuple[str, str], tuple[str, ...]] = {
    (LINE, LINE): ("parallel",),
    (PLANE, PLANE): ("parallel",),
    (LINE, PLANE): ("perpendicular",),
}
ACROSS: dict[tuple[str, str], tuple[str, ...]] = {
    (LINE, LINE): ("perpendicular",),
    (PLANE, PLANE): ("perpendicular",),
    (LINE, PLANE): ("parallel",),
}
BY_SHAPES: dict[str, dict[tuple[str, str], tuple[str, ...]]] = {
    "Coincident": COINCIDENT, "Concentric": CONCENTRIC, "Parallel": PARALLEL_TO, "Perpendicular": ACROSS,
}  # fmt: skip
"""Kinds of joints by constraint and by the shapes of their ends i and j, in the order of `RANK`."""
RANK = (POINT, CIRCLE, LINE, PLANE)


def joint(name: str, node: Node, ends: Ends) -> Iterator[Tie]:
    """Yield the joints of a <Weld>, <Revolute>, <Prismatic> ...; the follower is marker i, the base marker j."""
    where = f"joint {name}"
    node.get("name")
    i, j = (ends.frame(where, node.find(tag)) for tag in ("FollowerFrame", "BaseFrame"))
    if i.seat.part == j.seat.part:
        raise Left("both ends are on one rigid body")
    if node.tag == PIN_SLOT:
        slot = Seat(j.seat.part, Frame(j.seat.frame.position, j.seat.frame.axes @ X_AS_Z))
        yield Tie(name, "point_on_line", i.seat, slot)
        yield Tie(f"{name}_axes", "parallel", i.seat, j.seat)
    elif node.tag in JOINTS:
        yield Tie(name, JOINTS[node.tag], i.seat, j.seat)
    else:
        raise Left(f"{node.tag} joints are not supported")


def mate(name: str, node: Node, ends: Ends) -> Iterator[Tie]:
    """Yield the joints of a <Coincident>, <Concentric>, <Distance> ... between two shapes."""
    node.get("name")
    found = [ends.geometry(f"constraint {name}", one) for one in node.findall("ConstraintGeometry")]
    if node.tag == "UnknownConstraint" or len(found) != 2 or not all(end.shape for end in found):
        raise Left("the export does not describe them")
    i, j = sorted(found, key=lambda end: RANK.index(end.shape))
    if i.seat.part == j.seat.part:
        raise Left("both ends are on one rigid body")
    if node.tag in MEASURED:
        yield from MEASURED[node.tag](name, i, j)
        return
    kinds = BY_SHAPES.get(node.tag, {}).get((i.shape, j.shape))
    if kinds is None:
        raise Left(_unfit(node.tag, i, j))
    for kind, suffix in zip(kinds, ("", "_axes"), strict=False):
        yield Tie(f"{name}{suffix}", kind, i.seat, j.seat)


def _unfit(tag: str, i: End, j: End) -> str:
    return f"{tag} of {i.shape} and {j.shape} is not supported"


def _angle(name: str, i: End, j: End) -> Iterator[Tie]:
    """Yield the joint that keeps the drawn angle between two directions."""
    if POINT in (i.shape, j.shape):
        raise Left(_unfit("Angle", i, j))
    if np.linalg.norm(np.cross(i.z, j.z)) < PARALLEL:
        yield Tie(name, "parallel", i.seat, j.seat)
    else:
        yield at_angle(name, i.seat, j.seat, float(i.z @ j.z))


def _distance(name: str, i: End, j: End) -> Iterator[Tie]:
    """Yield the joints that keep the drawn distance between two shapes."""
    apart = i.drawn.position - j.drawn.position
    size = float(np.linalg.norm(apart))
    match i.shape, j.shape:
        case (("point" | "line" | "plane") as shape, "plane"):
            moved = j.moved(j.drawn.position + j.z * (j.z @ apart))
            for kind, suffix in zip(COINCIDENT[shape, PLANE], ("", "_axes"), strict=False):
                yield Tie(f"{name}{suffix}", kind, i.seat, moved.seat)
        case ("point", "point") if size > 0:
            yield Tie(name, "distance", i.seat, j.seat, {"length": size})
        case ("point", "point"):
            yield Tie(name, "spherical", i.seat, j.seat)
        case (("point" | "line") as shape, "line"):
            across = float(np.linalg.norm(np.cross(j.z, apart)))
            if across <= PARALLEL * max(1.0, size):
                yield Tie(name, COINCIDENT[shape, LINE][0], i.seat, j.seat)
                return
            yield off_axis(name, i.seat, j.seat, across)
            if shape == LINE:
                yield Tie(f"{name}_axes", "parallel", i.seat, j.seat)
        case _:
            raise Left(_unfit("Distance", i, j))


MEASURED: dict[str, Callable[[str, End, End], Iterator[Tie]]] = {"Angle": _angle, "Distance": _distance}
"""Constraints with a value, which is that of the drawn pose."""
