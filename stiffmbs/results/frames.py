"""Frames of markers at one instant, and principal axes of bodies over time.

The plane is the x-y plane of space.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from ..compile.system import System

OWN_ARE_PRINCIPAL = np.array([1.0, 0.0, 0.0, 0.0])


def in_own_axes(
    system: System, q: np.ndarray, u: np.ndarray, acceleration: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coordinates, velocities and accelerations of the described bodies, one row per instant.

    Revolution counters and states are left out.  The arrays are returned unchanged in the plane, or if all own axes are
    principal ones.
    """
    axes = system.principal_axes
    q = q[:, : system.n_pose]
    if own_are_principal(system):
        return q, u, acceleration
    return _turned_back(q, CONJUGATE * axes), _seen_from(u, axes), _seen_from(acceleration, axes)


def own_are_principal(system: System) -> bool:
    """Return True in the plane, and if the own axes of all bodies are principal ones."""
    axes = system.principal_axes
    return not axes.size or np.array_equal(axes, np.broadcast_to(OWN_ARE_PRINCIPAL, axes.shape))


def from_own_axes(system: System, q: np.ndarray) -> np.ndarray:
    """Return the solver's coordinates from those of the described bodies."""
    return _turned_back(q, system.principal_axes) if system.principal_axes.size else q


def rates_from_own_axes(system: System, u: np.ndarray) -> np.ndarray:
    """Return the solver's velocities from those of the described bodies."""
    return _seen_from(u, CONJUGATE * system.principal_axes) if system.principal_axes.size else u


def _turned_back(q: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Replace every quaternion p by p a."""
    bodies = q.reshape(len(q), -1, 7).copy()
    bodies[..., 3:] = times(bodies[..., 3:], axes)
    return bodies.reshape(q.shape)


def _seen_from(u: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Transform angular velocities w from axes rotated by a to the original ones: a w conj(a)."""
    bodies = u.reshape(len(u), -1, 6).copy()
    bodies[..., 3:] = rotated(axes, bodies[..., 3:])
    return bodies.reshape(u.shape)


Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Rows."""


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def turned(matrix: Matrix, v: Vector) -> Vector:
    """Return matrix times vector."""
    return dot(matrix[0], v), dot(matrix[1], v), dot(matrix[2], v)


def rotation(w: float, x: float, y: float, z: float) -> Matrix:
    """Return the rotation matrix of a unit quaternion."""
    return (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )


class BodyFrame:
    """Centre of mass of a body with the body's own axes; each part is read when it is needed.

    `read`: returns channels of the body as a vector, given their names; ``0`` stands for zero.
    """

    def __init__(self, read: Callable[[str], tuple[float, ...]], planar: bool) -> None:
        self._read, self._planar = read, planar

    def _vector(self, in_plane: str, in_space: str) -> Vector:
        x, y, z = self._read(in_plane if self._planar else in_space)
        return x, y, z

    @cached_property
    def matrix(self) -> Matrix:
        """Rotation matrix, with the axes as columns."""
        if self._planar:
            (angle,) = self._read("angle")
            c, s = math.cos(angle), math.sin(angle)
            return (c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)
        return rotation(*self._read("q0 q1 q2 q3"))

    @cached_property
    def point(self) -> Vector:
        """Position, m."""
        return self._vector("x y 0", "x y z")

    @cached_property
    def velocity(self) -> Vector:
        """Velocity, m/s."""
        return self._vector("vx vy 0", "vx vy vz")

    @cached_property
    def acceleration(self) -> Vector:
        """Acceleration, m/s^2."""
        return self._vector("ax ay 0", "ax ay az")

    @cached_property
    def omega(self) -> Vector:
        """Angular velocity, rad/s."""
        return self._vector("0 0 omega", "") if self._planar else turned(self.matrix, self._vector("", "wx wy wz"))

    @cached_property
    def alpha(self) -> Vector:
        """Angular acceleration, rad/s^2."""
        return self._vector("0 0 alpha", "") if self._planar else turned(self.matrix, self._vector("", "wdx wdy wdz"))


class GroundFrame(BodyFrame):
    """Ground, at rest."""

    def __init__(self) -> None:
        super().__init__(lambda names: (0.0,) * len(names.split()), planar=True)


class MarkerFrame:
    """Marker of a body.

    `point`: from the centre of mass in the body's own axes, m. `orientation`: quaternion of the marker's axes in those
    of the body.
    """

    def __init__(self, body: BodyFrame, point: Vector, orientation: tuple[float, float, float, float]) -> None:
        self._body, self._point, self._orientation = body, point, orientation

    @cached_property
    def _arm(self) -> Vector:
        return turned(self._body.matrix, self._point)

    @cached_property
    def axes(self) -> Matrix:
        """Unit axes in ground axes."""
        by_rows, own = self._body.matrix, rotation(*self._orientation)
        x, y, z = (turned(by_rows, (own[0][k], own[1][k], own[2][k])) for k in range(3))
        return x, y, z

    @property
    def point(self) -> Vector:
        """Position, m."""
        return plus(self._body.point, self._arm)

    @property
    def velocity(self) -> Vector:
        """Velocity, m/s."""
        return plus(self._body.velocity, cross(self._body.omega, self._arm))

    @property
    def acceleration(self) -> Vector:
        """Acceleration, m/s^2."""
        omega, arm = self._body.omega, self._arm
        turning = plus(cross(self._body.alpha, arm), cross(omega, cross(omega, arm)))
        return plus(self._body.acceleration, turning)

    @property
    def omega(self) -> Vector:
        """Angular velocity, rad/s."""
        return self._body.omega

    @property
    def alpha(self) -> Vector:
        """Angular acceleration, rad/s^2."""
        return self._body.alpha
