"""Quaternion products in arrays, scalar part first; (..., 4) for quaternions, (..., 3) for vectors.

Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985.
"""

from __future__ import annotations

import numpy as np

CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])
"""Factors of the components for the conjugate."""


def times_vector(p: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return p w for vectors w as quaternions without scalar part."""
    p0, p1, p2, p3 = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    w1, w2, w3 = w[..., 0], w[..., 1], w[..., 2]
    scalar = -p1 * w1 - p2 * w2 - p3 * w3
    product = np.empty((*scalar.shape, 4))
    product[..., 0] = scalar
    product[..., 1] = p0 * w1 + p2 * w3 - p3 * w2
    product[..., 2] = p0 * w2 + p3 * w1 - p1 * w3
    product[..., 3] = p0 * w3 + p1 * w2 - p2 * w1
    return product


def times(p: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return p q: the orientation q given in the axes of p."""
    return other[..., :1] * p + times_vector(p, other[..., 1:])


def rotated(p: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return vectors rotated by unit quaternions, p v conj(p)."""
    across = 2.0 * np.cross(p[..., 1:], v)
    return v + p[..., :1] * across + np.cross(p[..., 1:], across)


def rotation_vector(p: np.ndarray) -> np.ndarray:
    """Return axis times angle (at most pi, rad) of rotations p, shape (..., 3)."""
    p = np.where(p[..., :1] < 0, -p, p)
    half = np.linalg.norm(p[..., 1:], axis=-1, keepdims=True)
    return p[..., 1:] * np.where(half > 0, 2 * np.arctan2(half, p[..., :1]) / np.where(half > 0, half, 1.0), 2.0)
