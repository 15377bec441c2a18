"""Measures between two markers over time, named as in Adams."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from .marker_motion import MarkerMotion

Between = Callable[[MarkerMotion, MarkerMotion], np.ndarray]
ALIGNED = 1e-12
"""Sine of the angle between two z axes below which they count as parallel."""

VECTORS: dict[str, Between] = {
    "d": lambda i, j: i.point - j.point,
    "v": lambda i, j: i.velocity - j.velocity,
    "w": lambda i, j: i.omega - j.omega,
    "acc": lambda i, j: i.acceleration - j.acceleration,
    "wdt": lambda i, j: i.alpha - j.alpha,
}
"""Vectors in ground axes, shape (n, 3), by the name of their components without the last letter."""
MAGNITUDES = {f"{kind}m": between for kind, between in VECTORS.items()}


def _distance_rate(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    way = i.point - j.point
    return np.einsum("nk,nk->n", way, i.velocity - j.velocity) / np.linalg.norm(way, axis=1)


def _az(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    x = i.axis(0, j)
    return np.arctan2(x[:, 1], x[:, 0])


def _psi(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    """Return the first Euler angle of the sequence z, x, z; if the z axes are parallel, it is the whole rotation."""
    z = i.axis(2, j)
    return np.where(np.hypot(z[:, 0], z[:, 1]) > ALIGNED, np.arctan2(z[:, 0], -z[:, 1]), _az(i, j))


def _theta(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    z = i.axis(2, j)
    return np.arctan2(np.hypot(z[:, 0], z[:, 1]), z[:, 2])


def _phi(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    z = j.axis(2, i)
    return np.where(np.hypot(z[:, 0], z[:, 1]) > ALIGNED, np.arctan2(z[:, 0], z[:, 1]), 0.0)


def _quaternion(k: int, i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    return i.relative(j)[:, k]


SCALARS: dict[str, Between] = {
    "vr": _distance_rate,
    "psi": _psi, "theta": _theta, "phi": _phi,
    **{f"q{k}": partial(_quaternion, k) for k in range(4)},
}  # fmt: skip
"""Scalar measures, shape (n,)."""
