"""Frames of markers at one instant, in numbers: their positions, velocities and accelerations in ground axes.

The plane is the x-y plane of space.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Rows."""
AT_REST: Vector = (0.0, 0.0, 0.0)


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

    Parameters
    ----------
    read : callable
        Returns channels of the body as a vector, given their names; ``0`` stands for zero.
    planar : bool
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

    Parameters
    ----------
    body : BodyFrame
    point : tuple of float
        From the centre of mass in the body's own axes, m.
    orientation : tuple of float
        Quaternion of the marker's axes in those of the body.
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
