"""Solids and outlines in their own axes, and rotations of axes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from ...results.scales import ROUNDING
from .scene_graph import Line, Solid

ALONG = 0.9
"""Cosine above which two directions count as parallel."""


def rotation(p: np.ndarray) -> np.ndarray:
    """Return the rotation matrices of unit quaternions, shape (..., 3, 3); their columns are the oriented axes."""
    return Rotation.from_quat(np.asarray(p, dtype=float)[..., [1, 2, 3, 0]]).as_matrix()


def across(direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors normal to a direction and to each other; for a planar direction the first is planar."""
    d = direction / (np.linalg.norm(direction) or 1.0)
    up = np.array([0.0, 0.0, 1.0]) if abs(d[2]) < ALONG else np.array([1.0, 0.0, 0.0])
    first = np.cross(up, d)
    length = float(np.linalg.norm(first))
    first = first / length if length > 0 else np.array([1.0, 0.0, 0.0])
    return first, np.cross(d, first)


def axes_along(direction: np.ndarray) -> np.ndarray:
    """Return right-handed axes, the columns of a matrix, whose z has a given direction."""
    first, second = across(direction)
    return np.column_stack([first, second, direction / (np.linalg.norm(direction) or 1.0)])


MOST_FACES = 5_000
"""Number of faces of a mesh from which on its edges are not drawn."""
ROUND = 24
"""Number of corners of a circle."""


def circle(radius: float, start: float = 0.0, end: float = 2 * math.pi, corners: int = ROUND) -> np.ndarray:
    """Return the points of an arc in the x-y plane, counterclockwise, both ends included, shape (corners + 1, 3)."""
    angles = np.linspace(start, end, corners + 1)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.zeros_like(angles)])


def flat(points: np.ndarray) -> Solid:
    """Return a filled outline."""
    return Solid(np.asarray(points, dtype=float), (np.arange(len(points)),), closed=False)


def outline(points: np.ndarray, width: float = 1.0) -> Line:
    """Return a closed line."""
    return Line(np.vstack([points, points[:1]]), width)


def disc(radius: float) -> Solid:
    """Return a filled circle in the x-y plane."""
    return flat(circle(radius)[:-1])


def rectangle(width: float, height: float) -> np.ndarray:
    """Return the corners of a rectangle in the x-y plane about the origin, shape (4, 3)."""
    x, y = width / 2, height / 2
    return np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])


def prism(base: np.ndarray, low: float, high: float) -> Solid:
    """Return the prism over a convex outline of the x-y plane between two heights."""
    n = len(base)
    lift = np.array([0.0, 0.0, 1.0])
    around = [np.array([k, (k + 1) % n, n + (k + 1) % n, n + k]) for k in range(n)]
    faces = (np.arange(n)[::-1], np.arange(n, 2 * n), *around)
    return Solid(np.vstack([base + low * lift, base + high * lift]), faces)


def box(size: tuple[float, float, float]) -> Solid:
    """Return a block about the origin."""
    return prism(rectangle(size[0], size[1]), -size[2] / 2, size[2] / 2)


def cylinder(radius: float, length: float, corners: int = ROUND) -> Solid:
    """Return a cylinder about z, centred at the origin."""
    return prism(circle(radius, corners=corners)[:-1], -length / 2, length / 2)


def sphere(radius: float, corners: int = 16) -> Solid:
    """Return a ball about the origin."""
    rings = corners // 2
    tilt = np.linspace(0, math.pi, rings + 1)[1:-1]
    turn = np.arange(corners) * 2 * math.pi / corners
    ring = [
        radius * np.column_stack([np.sin(a) * np.cos(turn), np.sin(a) * np.sin(turn), np.cos(a) + 0 * turn])
        for a in tilt
    ]
    vertices = np.vstack([*ring, [[0, 0, radius], [0, 0, -radius]]])
    top, bottom = len(vertices) - 2, len(vertices) - 1
    faces = []
    for k in range(corners):
        n = (k + 1) % corners
        faces.append(np.array([top, k, n]))
        faces += [
            np.array([r * corners + k, (r + 1) * corners + k, (r + 1) * corners + n, r * corners + n])
            for r in range(len(tilt) - 1)
        ]
        last = (len(tilt) - 1) * corners
        faces.append(np.array([bottom, last + n, last + k]))
    return Solid(vertices, tuple(faces))


def edged(solid: Solid, sharp: float = 0.8) -> Solid:
    """Return a solid with its sharp edges, at which the normals of two faces differ."""
    normals = [face_normal(solid.vertices[face]) for face in solid.faces]
    sides: dict[tuple[int, int], list[int]] = {}
    for k, face in enumerate(solid.faces):
        for a, b in zip(face, np.roll(face, -1), strict=True):
            sides.setdefault((min(int(a), int(b)), max(int(a), int(b))), []).append(k)
    found = [
        (*pair, one[0], one[-1])
        for pair, one in sides.items() if len(one) == 1 or normals[one[0]] @ normals[one[1]] < sharp
    ]  # fmt: skip
    return replace(solid, edges=np.array(found, dtype=int).reshape(-1, 4))


def face_normal(points: np.ndarray) -> np.ndarray:
    """Return the unit normal of a flat face by Newell's method, or zero for a degenerate face."""
    after = np.concatenate([points[1:], points[:1]])
    products = points[:, [1, 2, 0]] * after[:, [2, 0, 1]] - points[:, [2, 0, 1]] * after[:, [1, 2, 0]]
    across = products.sum(axis=0)
    length = float(np.linalg.norm(across))
    return across / length if length > 0 else across


def moved(solid: Solid, point: np.ndarray, axes: np.ndarray) -> Solid:
    """Transform a solid from a marker's axes to the axes in which the marker is given."""
    return replace(solid, vertices=point + solid.vertices @ axes.T)


def moved_line(line: Line, point: np.ndarray, axes: np.ndarray) -> Line:
    """Transform a line from a marker's axes to the axes in which the marker is given."""
    return Line(point + line.points @ axes.T, line.width, line.dashed)


def triangles(solid: Solid) -> np.ndarray:
    """Return the triangles of all faces, shape (m, 3), indices into the vertices."""
    found = [np.zeros((0, 3), dtype=int)]
    for length in {len(face) for face in solid.faces}:
        faces = np.array([face for face in solid.faces if len(face) == length])
        points = solid.vertices[faces]
        edges = np.roll(points, -1, axis=1) - points
        turns = np.cross(edges, np.roll(edges, -1, axis=1))
        normals = np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1, keepdims=True)
        left = (turns * normals).sum(axis=2)
        if length > 4 and length % 2 == 0:
            convex = (left >= -ROUNDING * np.abs(left).max(axis=1, keepdims=True)).all(axis=1)
            sizes = np.roll(np.linalg.norm(turns, axis=2), 1, axis=1)  # of the ears
            at_odd = sizes[:, 1::2].sum(axis=1) > sizes[:, ::2].sum(axis=1)
            found += [faces[convex & (at_odd == first)][:, _by_ears(length, first)].reshape(-1, 3) for first in (0, 1)]
        else:
            convex = (left > 0).all(axis=1)
            fan = [(0, k, k + 1) for k in range(1, length - 1)]
            found.append(faces[convex][:, fan].reshape(-1, 3))
        for face, corners in zip(faces[~convex], points[~convex], strict=True):
            found.append(face[_of_face(corners)])
    return np.concatenate(found)


def _by_ears(length: int, first: int) -> list[tuple[int, int, int]]:
    """Cut off every other corner of a convex face, from the first one on, and again of what is left.

    On a face of an element of second order, whose corners are every other node, each triangle has nodes of one neighbourhood.
    """
    found, order = [], list(range(length))
    while len(order) > 4 and len(order) % 2 == 0:
        n = len(order)
        found += [(order[k - 1], order[k], order[(k + 1) % n]) for k in range(first, n, 2)]
        order = order[1 - first :: 2]
    return found + [(order[0], order[k], order[k + 1]) for k in range(1, len(order) - 1)]


def _of_face(points: np.ndarray) -> list[tuple[int, int, int]]:
    """Cut ears off a flat face, in its own plane (Meisters, American Mathematical Monthly 82, 1975)."""
    if len(points) == 3:
        return [(0, 1, 2)]
    normal = face_normal(points)
    axis = int(np.argmax(np.abs(normal)))
    first, second = ((1, 2), (2, 0), (0, 1))[axis]
    sign = 1.0 if normal[axis] >= 0 else -1.0
    plane = [(x, sign * y) for x, y in points[:, [first, second]].tolist()]
    left = list(range(len(points)))
    found = []
    while len(left) > 3:
        ear = next((k for k in range(len(left)) if _is_ear(plane, left, k)), 1)
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        left.pop(ear)
    return [*found, (left[0], left[1], left[2])]


Flat = tuple[float, float]


def _is_ear(plane: list[Flat], left: list[int], k: int) -> bool:
    corners = (k - 1) % len(left), k, (k + 1) % len(left)
    a, b, c = (plane[left[m]] for m in corners)
    if _turn(a, b, c) <= 0:
        return False
    return not any(_inside(plane[left[m]], a, b, c) for m in range(len(left)) if m not in corners)


def _turn(a: Flat, b: Flat, c: Flat) -> float:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def _inside(p: Flat, a: Flat, b: Flat, c: Flat) -> bool:
    return _turn(a, b, p) >= 0 and _turn(b, c, p) >= 0 and _turn(c, a, p) >= 0
