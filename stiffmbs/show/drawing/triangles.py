"""Triangulation of flat faces by ear clipping (Meisters, American Math. Monthly 82, 1975, 648-651)."""

from __future__ import annotations

import numpy as np

from .scene_graph import Solid
from .solids import face_normal


def triangles(solid: Solid) -> np.ndarray:
    """Return the triangles of all faces, shape (m, 3), indices into the vertices."""
    found: list[tuple[int, int, int]] = []
    for face in solid.faces:
        points = solid.vertices[face]
        found += [(int(face[a]), int(face[b]), int(face[c])) for a, b, c in _of_face(points)]
    return np.array(found, dtype=int).reshape(-1, 3)


def _of_face(points: np.ndarray) -> list[tuple[int, int, int]]:
    normal = face_normal(points)
    left = list(range(len(points)))
    found = []
    while len(left) > 3:
        ear = next((k for k in range(len(left)) if _is_ear(points, left, k, normal)), 1)
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        left.pop(ear)
    return [*found, (left[0], left[1], left[2])]


def _is_ear(points: np.ndarray, left: list[int], k: int, normal: np.ndarray) -> bool:
    a, b, c = (points[left[(k + step) % len(left)]] for step in (-1, 0, 1))
    if np.cross(b - a, c - b) @ normal <= 0:
        return False
    others = [points[left[m]] for m in range(len(left)) if m not in ((k - 1) % len(left), k, (k + 1) % len(left))]
    return not any(_inside(point, a, b, c, normal) for point in others)


def _inside(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray, normal: np.ndarray) -> bool:
    return all(np.cross(end - start, p - start) @ normal >= 0 for start, end in ((a, b), (b, c), (c, a)))
