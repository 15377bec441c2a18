"""Pose that a marker should have, and the distance to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ...errors import InputError
from .markers import MarkerPose

ORTHOGONAL: Final = 1e-6
"""Largest departure of R^T R from the unit matrix."""


@dataclass(frozen=True)
class Wanted:
    """Pose of a marker; None for a part that is free. `size`: of the mechanism, m."""

    position: np.ndarray | None
    rotation: np.ndarray | None
    size: float

    @classmethod
    def of(cls, position: object, rotation: object, dimensions: int, size: float) -> Wanted:
        """Return a valid pose; raise an InputError if a part has another shape or is not a rotation."""
        if position is None and rotation is None:
            raise InputError("inverse_kinematics: found no position and no rotation, expected one of them or both")
        place = None if position is None else _numbers("position", position, (dimensions,))
        turn = None if rotation is None else _numbers("rotation", rotation, (dimensions, dimensions))
        if turn is not None and (
            np.abs(turn.T @ turn - np.eye(dimensions)).max() > ORTHOGONAL or np.linalg.det(turn) < 0
        ):
            raise InputError("rotation: found a matrix that is no rotation, expected orthogonal columns of length 1, right-handed")
        return cls(place, turn, size)

    def gap(self, pose: MarkerPose) -> np.ndarray:
        """Return the move to the pose: displacement in sizes of the mechanism, then rotation vector in ground axes, rad."""
        parts = []
        if self.position is not None:
            parts.append((self.position - pose.position) / self.size)
        if self.rotation is not None:
            parts.append(_vector(self.rotation @ pose.rotation.T))
        return np.concatenate(parts)

    def rows(self, jacobian: np.ndarray) -> np.ndarray:
        """Return the rows of a Jacobian that belong to the gap."""
        n = 3 if len(jacobian) == 6 else 2
        parts = []
        if self.position is not None:
            parts.append(jacobian[:n] / self.size)
        if self.rotation is not None:
            parts.append(jacobian[n:])
        return np.vstack(parts)

    def is_met(self, gap: np.ndarray, tolerance: float) -> bool:
        """Return True if the gap is within a tolerance."""
        return bool(np.abs(gap).max() <= tolerance)

    def described(self, gap: np.ndarray) -> str:
        """Return the lengths of the gap as text."""
        n = 0 if self.position is None else len(self.position)
        parts = [f"{self.size * np.linalg.norm(gap[:n]):.3g} m"] if n else []
        return " and ".join([*parts, *([f"{np.linalg.norm(gap[n:]):.3g} rad"] if self.rotation is not None else [])])


def _numbers(what: str, given: object, shape: tuple[int, ...]) -> np.ndarray:
    try:
        found = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{what}: found {given!r}, expected numbers") from None
    if found.shape != shape or not np.isfinite(found).all():
        raise InputError(f"{what}: found {np.array2string(found)}, expected finite numbers in the shape {shape}")
    return found


def _vector(turn: np.ndarray) -> np.ndarray:
    """Return axis times angle of a rotation matrix; the angle in the plane."""
    if len(turn) == 2:
        return np.array([np.arctan2(turn[1, 0], turn[0, 0])])
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(turn).as_rotvec())
