"""Poses of bodies fixed to parent bodies, and their states from those of the parents."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


class PlanarPoses(NamedTuple):
    """Poses in the plane. `point`, `angle`: centres of mass and axes in those of the parent bodies, m, rad."""

    point: np.ndarray
    angle: np.ndarray

    @classmethod
    def none(cls, count: int) -> PlanarPoses:
        """Return identity poses."""
        return cls(np.zeros((count, 2)), np.zeros(count))

    @classmethod
    def of(cls, placements: Sequence[Any]) -> PlanarPoses:
        """Return the poses of planar placements."""
        return cls(np.array([place.point for place in placements]), np.array([place.angle for place in placements]))

    @property
    def moved(self) -> bool:
        """True if any pose differs from that of its parent body."""
        return bool(self.point.any() or self.angle.any())

    def inverse(self) -> PlanarPoses:
        """Return the poses of the parent bodies on the bodies."""
        return PlanarPoses(-_turned(-self.angle, self.point), -self.angle)

    def like(self, q: np.ndarray, parent: np.ndarray) -> PlanarPoses:
        """Return the same poses: those in the plane have one representation."""
        return self

    def carried(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states of the bodies from those of their parents, shapes (..., k, n_q) and (..., k, n_u)."""
        arm = _turned(q[..., 2], self.point)
        across = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        place = np.concatenate([q[..., :2] + arm, (q[..., 2] + self.angle)[..., None]], axis=-1)
        return place, np.concatenate([u[..., :2] + u[..., 2:] * across, u[..., 2:]], axis=-1)


class SpatialPoses(NamedTuple):
    """Poses in space.

    `point`, `turn`: centres of mass and principal axes in those of the parent bodies, m, quaternions.
    """

    point: np.ndarray
    turn: np.ndarray

    @classmethod
    def none(cls, count: int) -> SpatialPoses:
        """Return identity poses."""
        return cls(np.zeros((count, 3)), np.tile(IDENTITY, (count, 1)))

    @classmethod
    def of(cls, placements: Sequence[Any]) -> SpatialPoses:
        """Return the poses of placements in space."""
        return cls(
            np.array([place.point for place in placements]), np.array([place.orientation for place in placements])
        )

    @property
    def moved(self) -> bool:
        """True if any pose differs from that of its parent body."""
        return bool(self.point.any() or np.any(self.turn != IDENTITY))

    def inverse(self) -> SpatialPoses:
        """Return the poses of the parent bodies on the bodies."""
        back = CONJUGATE * self.turn
        return SpatialPoses(-rotated(back, self.point), back)

    def like(self, q: np.ndarray, parent: np.ndarray) -> SpatialPoses:
        """Choose the sign of each quaternion that is continuous with that of the parent's first body.

        `q` of shape (k, n_q): coordinates of the bodies. `parent` of shape (k,): number of each body's parent body.
        """
        _, first, number = np.unique(parent, return_index=True, return_inverse=True)
        of_parent = times(q[first, 3:], CONJUGATE * self.turn[first])[number]
        against = np.sum(times(of_parent, self.turn) * q[:, 3:], axis=1) < 0
        return SpatialPoses(self.point, np.where(against[:, None], -self.turn, self.turn))

    def carried(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states of the bodies from those of their parents, as `PlanarPoses.carried`."""
        p, w = q[..., 3:], u[..., 3:]
        arm = rotated(p, self.point)
        velocity = u[..., :3] + np.cross(rotated(p, w), arm)
        place = np.concatenate([q[..., :3] + arm, times(p, self.turn)], axis=-1)
        return place, np.concatenate([velocity, rotated(CONJUGATE * self.turn, w)], axis=-1)


def _turned(phi: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Rotate points from body axes to ground axes."""
    c, s, (xi, eta) = np.cos(phi), np.sin(phi), np.moveaxis(points, -1, 0)
    return np.stack([c * xi - s * eta, s * xi + c * eta], axis=-1)


BodyFixedPoses = PlanarPoses | SpatialPoses
BODY_FIXED_POSES: dict[int, type[PlanarPoses] | type[SpatialPoses]] = {2: PlanarPoses, 3: SpatialPoses}
