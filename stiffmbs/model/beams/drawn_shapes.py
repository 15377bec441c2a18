"""Shapes of the nodes of a beam for drawings: its cross section along the axis, or the axis alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from ...elements.spatial.orientation import from_matrix
from .discretise import Node
from .open_section import of_rectangles
from .section import Circle, Section, Tube

Shape = dict[str, object]
"""Entry of a shape in a scene."""


def planar_shape(node: Node, along: Sequence[np.ndarray]) -> Shape:
    """Return the side view of a part of the beam, in the node's axes.

    `along`: points of the axis from half way to the neighbours, in the node's axes, shape (3,).
    """
    points = np.array(along)[:, :2]
    low, high = _heights(node.section)
    if high > low:
        ways = np.diff(points, axis=0)
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        ways = np.array([ways[0], *(a + b for a, b in pairwise(ways)), ways[-1]])
        normals = np.column_stack([-ways[:, 1], ways[:, 0]]) / np.linalg.norm(ways, axis=1)[:, None]
        points = np.concatenate([points + low * normals, (points + high * normals)[::-1]])
    return {"type": "polyline", "points": points.tolist(), "closed": high > low}


def spatial_shapes(node: Node, along: Sequence[np.ndarray]) -> list[Shape]:
    """Return boxes or cylinders of a part of the beam, in the node's axes; arguments as for `planar_shape`."""
    found = [shape for a, b in pairwise(along) for shape in _between(node.section, a, b)]
    return found or [{"type": "polyline", "points": np.array(along).tolist()}]


def _between(section: Section | None, a: np.ndarray, b: np.ndarray) -> Iterator[Shape]:
    """Yield the shapes of a cross section between two points of the axis."""
    length, middle = float(np.linalg.norm(b - a)), (a + b) / 2
    axes = _turned_to((b - a) / length)
    if isinstance(section, Circle | Tube):
        yield {
            "type": "cylinder", "radius": section.diameter / 2, "length": length, "point": middle.tolist(),
            "orientation": list(from_matrix(axes[:, [1, 2, 0]])),
        }  # fmt: skip
        return
    for low_2, high_2, low_3, high_3 in _about_centroid(section):
        centre = middle + axes @ [0.0, (low_2 + high_2) / 2, (low_3 + high_3) / 2]
        yield {
            "type": "box", "size": [length, high_2 - low_2, high_3 - low_3], "point": centre.tolist(),
            "orientation": list(from_matrix(axes)),
        }  # fmt: skip


def _turned_to(tangent: np.ndarray) -> np.ndarray:
    """Return the axes of a node, turned by the least angle so that the first is a tangent: at a corner those beyond it."""
    across = np.array([0.0, -tangent[2], tangent[1]])  # e_1 x tangent
    turn = np.array([[0, -across[2], across[1]], [across[2], 0, -across[0]], [-across[1], across[0], 0]])
    return np.asarray(np.eye(3) + turn + turn @ turn / (1 + tangent[0]))  # no axis turns straight back


def _about_centroid(section: Section | None) -> np.ndarray:
    """Return the rectangles of a section about its centroid, the axis of the beam, shape (n, 4)."""
    rectangles = section.rectangles() if section else []
    if not rectangles:
        return np.zeros((0, 4))
    _, centroid, *_ = of_rectangles(rectangles)
    return np.array(rectangles) - np.repeat(centroid, 2)


def _heights(section: Section | None) -> tuple[float, float]:
    """Return the lower and the upper end of a section along axis 3, from the centroid; zeros if its form is unknown."""
    if isinstance(section, Circle | Tube):
        return -section.diameter / 2, section.diameter / 2
    found = _about_centroid(section)
    return (float(found[:, 2].min()), float(found[:, 3].max())) if len(found) else (0.0, 0.0)
