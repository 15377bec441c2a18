"""Coordinates and velocities of planar and spatial bodies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .quaternions import CONJUGATE, rotation_vector, times, times_vector


@dataclass(frozen=True)
class BodyKind:
    """Names of the coordinates q, velocities u and accelerations u' of one body.

    The first `linear` of each belong to the centre of mass, in ground axes; q' = Z(q) u. `dimensions`: 2 or 3.
    `reactions`: components of force and torque. `ground`, `ground_turn`: coordinates of the ground, and its orientation
    values in the array `turn`.
    """

    dimensions: int
    positions: tuple[str, ...]
    velocities: tuple[str, ...]
    accelerations: tuple[str, ...]
    reactions: tuple[str, ...]
    ground: tuple[float, ...]
    ground_turn: tuple[float, ...]

    @cached_property
    def n_q(self) -> int:
        """Number of coordinates of a body."""
        return len(self.positions)

    @cached_property
    def n_u(self) -> int:
        """Number of velocities of a body."""
        return len(self.velocities)

    @cached_property
    def linear(self) -> int:
        """Number of coordinates, and of velocities, of the centre of mass."""
        return self.dimensions

    @property
    def turn_stride(self) -> int:
        """Entries of the array `turn` per coordinate."""
        return len(self.ground_turn) // self.n_q

    def pose(self, q: np.ndarray, body: int) -> str:
        """Return the orientation of one body as text, from the coordinates of all."""
        own = q[self.n_q * body : self.n_q * (body + 1)]
        if self.dimensions == 2:
            return f"{own[2]:.4g} rad"
        return f"quaternion ({', '.join(f'{part:.4g}' for part in own[3:])})"

    def place(self, q: np.ndarray, body: int) -> str:
        """Return position and orientation of one body as text, from the coordinates of all."""
        own = q[self.n_q * body : self.n_q * (body + 1)]
        centre = f"({', '.join(f'{part:.6g}' for part in own[: self.linear])}) m"
        return f"{centre}, {np.degrees(own[2]):.6g} deg" if self.dimensions == 2 else f"{centre}, {self.pose(q, body)}"

    def straight(self, n_bodies: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the indices of coordinates whose rate is a velocity, and of these velocities."""
        count = self.n_q if self.n_q == self.n_u else self.linear
        bodies = np.arange(n_bodies)[:, None]
        q, u = self.n_q * bodies + np.arange(count), self.n_u * bodies + np.arange(count)
        return q.ravel(), u.ravel()

    def position_rates(self, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return q' = Z(q) u; the rates of coordinates after those of the bodies are zero."""
        if self.n_q == self.n_u:
            return _with_rest(u, q)
        of_q, of_u = self._parted(q, u)
        rates = np.zeros(len(q))
        of_bodies = rates[: of_q.size].reshape(of_q.shape)
        of_bodies[:, :3] = of_u[:, :3]
        of_bodies[:, 3:] = 0.5 * times_vector(of_q[:, 3:], of_u[:, 3:])
        return rates

    def _parted(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and velocities of the bodies as views, one row per body."""
        of_u = u.reshape(-1, self.n_u)
        return q[: self.n_q * len(of_u)].reshape(-1, self.n_q), of_u

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the pose after a displacement given as velocities times time; quaternions remain normalised."""
        if self.n_q == self.n_u:
            return q + _with_rest(step, q)
        there = q.astype(float)
        of_q, of_u = self._parted(there, step)
        half = 0.5 * of_u[:, 3:]
        angle = np.linalg.norm(half, axis=1, keepdims=True)
        p, vector = of_q[:, 3:], half * np.sinc(angle / np.pi)
        turned = np.cos(angle) * p + times_vector(p, vector)
        of_q[:, :3] += of_u[:, :3]
        of_q[:, 3:] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
        return there

    def move(self, q: np.ndarray, there: np.ndarray) -> np.ndarray:
        """Return the displacement between two poses as velocities times time, shape (n_u,): the inverse of `moved`."""
        if self.n_q == self.n_u:
            return there - q
        of_q, of_there = q.reshape(-1, self.n_q), there.reshape(-1, self.n_q)
        turned = rotation_vector(times(CONJUGATE * of_q[:, 3:], of_there[:, 3:]))
        return np.concatenate([of_there[:, :3] - of_q[:, :3], turned], axis=1).ravel()


def _with_rest(u: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the rates of the bodies' coordinates, padded with zeros."""
    return u if len(u) == len(q) else np.append(u, np.zeros(len(q) - len(u)))


PLANE = BodyKind(
    2,
    ("x", "y", "angle"),
    ("vx", "vy", "omega"),
    ("ax", "ay", "alpha"),
    ("fx", "fy", "torque"),
    (0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0),
)
"""Planar body: x, y and the angle phi; `turn` holds cos phi and sin phi in the places of x and y."""
SPACE = BodyKind(
    3,
    ("x", "y", "z", "q0", "q1", "q2", "q3"),
    ("vx", "vy", "vz", "wx", "wy", "wz"),
    ("ax", "ay", "az", "wdx", "wdy", "wdz"),
    ("fx", "fy", "fz", "tx", "ty", "tz"),
    (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 2.0),
)
"""Spatial body: x, y, z and a quaternion p; the angular velocity is in principal axes. `turn` holds the rotation matrix
A by rows, e = 2 p/|p|^2, and n = 2/|p|^2."""
QUATERNION = SPACE.positions[SPACE.linear :]
"""Labels of the quaternion of a spatial body."""
BODY_KINDS = {kind.dimensions: kind for kind in (PLANE, SPACE)}
