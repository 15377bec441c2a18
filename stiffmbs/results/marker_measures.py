"""Measures between two markers over time, named as in Adams."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ..compile.quaternions import CONJUGATE, times
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


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("nk,nk->n", a, b)


def _distance_rate(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    way = i.point - j.point
    return _dot(way, i.velocity - j.velocity) / np.linalg.norm(way, axis=1)


def _relative(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    """Return the quaternion of i's axes in j's, shape (n, 4)."""
    return times(j.orientation * CONJUGATE, i.orientation)


def _quaternion(k: int, i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    return _relative(i, j)[:, k]


def axis(k: int, i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    """Return the k-th axis of i in the axes of j, shape (n, 3)."""
    w, x, y, z = _relative(i, j).T
    return np.column_stack(
        (
            (w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)),
            (2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)),
            (2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z),
        )[k]
    )


def _az(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    x = axis(0, i, j)
    return np.arctan2(x[:, 1], x[:, 0])


def _psi(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    """Return the first Euler angle of the sequence z, x, z; if the z axes are parallel, it is the whole rotation."""
    z = axis(2, i, j)
    return np.where(np.hypot(z[:, 0], z[:, 1]) > ALIGNED, np.arctan2(z[:, 0], -z[:, 1]), _az(i, j))


def _theta(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    z = axis(2, i, j)
    return np.arctan2(np.hypot(z[:, 0], z[:, 1]), z[:, 2])


def _phi(i: MarkerMotion, j: MarkerMotion) -> np.ndarray:
    z = axis(2, j, i)
    return np.where(np.hypot(z[:, 0], z[:, 1]) > ALIGNED, np.arctan2(z[:, 0], z[:, 1]), 0.0)


SCALARS: dict[str, Between] = {
    "vr": _distance_rate,
    "psi": _psi, "theta": _theta, "phi": _phi,
    **{f"q{k}": partial(_quaternion, k) for k in range(4)},
}  # fmt: skip
"""Scalar measures, shape (n,)."""
