"""Rotations, and axes along a direction."""

from __future__ import annotations

import numpy as np

ALONG = 0.9
"""Cosine above which two directions count as parallel."""


def rotation(p: np.ndarray) -> np.ndarray:
    """Return the rotation matrices of unit quaternions, shape (..., 3, 3); their columns are the oriented axes."""
    w, x, y, z = np.moveaxis(np.asarray(p, dtype=float), -1, 0)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


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
