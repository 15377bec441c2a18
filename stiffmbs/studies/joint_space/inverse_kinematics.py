"""Pose that a marker should have, and the distance to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...errors import InputError, SolverError
from .markers import MarkerPose

ORTHOGONAL: Final = 1e-6
"""Largest departure of R^T R from the unit matrix."""

DAMPING: Final = 1e-3
"""First damping, relative to the square of the gap."""
LESS: Final = 0.2
"""Factor of the damping after a move that came nearer."""
MORE: Final = 10.0
"""Factor of the damping after a move that did not."""
ROUNDING: Final = 1e-12
"""Singular value of a Jacobian that is rounding, relative to the largest."""
LONGEST: Final = 0.5
"""Longest move of a coordinate, rad or sizes of the mechanism."""


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
            raise InputError(
                "rotation: found a matrix that is no rotation, expected orthogonal columns of length 1, right-handed"
            )
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


@dataclass(frozen=True)
class Reach:
    """Pose and Jacobian of a marker by coordinates, moves of coordinates, and the size of each rate."""

    pose: Callable[[np.ndarray], MarkerPose]
    jacobian: Callable[[np.ndarray], np.ndarray]
    moved: Callable[[np.ndarray, np.ndarray], np.ndarray]
    unit: np.ndarray


def nearest(
    reach: Reach, wanted: Wanted, q: np.ndarray, most_iterations: int, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the coordinates nearest to a pose that are found, and the gap that is left.

    The damping of Levenberg and Marquardt's method is in proportion to the square of the gap (Sugihara 2011, eq. 22).
    """
    gap, damping = wanted.gap(reach.pose(q)), DAMPING
    for _ in range(most_iterations):
        if wanted.is_met(gap, tolerance):
            break
        J = wanted.rows(reach.jacobian(q) * reach.unit)
        weight = damping * (gap @ gap + tolerance**2)
        along, values, across = np.linalg.svd(J, full_matrices=False)
        used = values > ROUNDING * values.max(
            initial=0.0
        )  # J has dependent rows if the marker has fewer motions than the gap
        move = across[used].T @ (values[used] / (values[used] ** 2 + weight) * (along.T @ gap)[used])
        move /= max(1.0, float(np.abs(move).max(initial=0.0)) / LONGEST)
        try:
            trial = reach.moved(q, reach.unit * move)
            left = wanted.gap(reach.pose(trial))
        except (InputError, SolverError):  # the loops cannot be closed there
            left = np.full(len(gap), np.inf)
        if left @ left < gap @ gap:
            q, gap, damping = trial, left, LESS * damping
        else:
            damping *= MORE
    return q, gap
