"""Which coordinates and velocities a body has, in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .quaternions import CONJUGATE, rotation_vector, times, times_vector


@dataclass(frozen=True)
class BodyKind:
    """The coordinates q, velocities u and accelerations u' of one body, by name.

    The first `linear` of each belong to its centre of mass, in ground axes; q' = Z(q) u.

    Attributes
    ----------
    dimensions : int
        2 or 3.
    positions, velocities, accelerations : tuples of str
    reactions : tuple of str
        The components of a force and a torque on it.
    ground, ground_turn : tuples of float
        The coordinates of the ground, and what kernels share of its orientation.
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
        """Coordinates of a body."""
        return len(self.positions)

    @cached_property
    def n_u(self) -> int:
        """Velocities of a body."""
        return len(self.velocities)

    @cached_property
    def linear(self) -> int:
        """How many of its coordinates, and of its velocities, are those of the centre of mass."""
        return self.dimensions

    @property
    def turn_stride(self) -> int:
        """Numbers in the array `turn` for each coordinate."""
        return len(self.ground_turn) // self.n_q

    def pose(self, q: np.ndarray, body: int) -> str:
        """The orientation of one body in words, from the coordinates of all."""
        own = q[self.n_q * body : self.n_q * (body + 1)]
        if self.dimensions == 2:
            return f"{own[2]:.4g} rad"
        return f"quaternion ({', '.join(f'{part:.4g}' for part in own[3:])})"

    def place(self, q: np.ndarray, body: int) -> str:
        """Where one body is and how it is turned, in words, from the coordinates of all."""
        own = q[self.n_q * body : self.n_q * (body + 1)]
        centre = f"({', '.join(f'{part:.6g}' for part in own[: self.linear])}) m"
        return f"{centre}, {np.degrees(own[2]):.6g} deg" if self.dimensions == 2 else f"{centre}, {self.pose(q, body)}"

    def straight(self, n_bodies: int) -> tuple[np.ndarray, np.ndarray]:
        """The coordinates whose rate is a velocity, and these velocities, by number."""
        count = self.n_q if self.n_q == self.n_u else self.linear
        bodies = np.arange(n_bodies)[:, None]
        q, u = self.n_q * bodies + np.arange(count), self.n_u * bodies + np.arange(count)
        return q.ravel(), u.ravel()

    def position_rates(self, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """q' = Z(q) u; what stands behind the bodies' coordinates is taken to rest."""
        if self.n_q == self.n_u:
            return _with_rest(u, q)
        of_q, of_u = self._parted(q, u)
        rates = np.zeros(len(q))
        of_bodies = rates[: of_q.size].reshape(of_q.shape)
        of_bodies[:, :3] = of_u[:, :3]
        of_bodies[:, 3:] = 0.5 * times_vector(of_q[:, 3:], of_u[:, 3:])
        return rates

    def _parted(self, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and velocities of the bodies, a row for each: views."""
        of_u = u.reshape(-1, self.n_u)
        return q[: self.n_q * len(of_u)].reshape(-1, self.n_q), of_u

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The pose after a move that is given as velocities times time; quaternions stay of length 1."""
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
        """What takes a pose of the bodies to another, as velocities times time: the inverse of `moved`, shape (n_u,)."""
        if self.n_q == self.n_u:
            return there - q
        of_q, of_there = q.reshape(-1, self.n_q), there.reshape(-1, self.n_q)
        turned = rotation_vector(times(CONJUGATE * of_q[:, 3:], of_there[:, 3:]))
        return np.concatenate([of_there[:, :3] - of_q[:, :3], turned], axis=1).ravel()


def _with_rest(u: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Rates of the bodies' coordinates, and zeros for what stands behind these."""
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
"""x, y and the angle phi; shared: cos phi and sin phi, in the places of x and y."""
SPACE = BodyKind(
    3,
    ("x", "y", "z", "q0", "q1", "q2", "q3"),
    ("vx", "vy", "vz", "wx", "wy", "wz"),
    ("ax", "ay", "az", "wdx", "wdy", "wdz"),
    ("fx", "fy", "fz", "tx", "ty", "tz"),
    (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 2.0),
)
"""x, y, z and a quaternion p; the angular velocity is that in the body's principal axes.  Shared: the rotation matrix A
row by row, e = 2 p/|p|^2, and n = 2/|p|^2 (`stiffmbs.compile.machine.native.orientation`)."""
BODY_KINDS = {kind.dimensions: kind for kind in (PLANE, SPACE)}
