"""Relative rotation of two orientations: rotation vector, tilt, and the conjugate torques."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import sympy as sp


class RotationVector(sp.Function):  # type: ignore[misc]
    """Factor from a quaternion's vector part to the rotation vector, or a derivative: RotationVector(h, order)."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        h, order = self.args
        return RotationVector(h, order + 1)


COSINE = sp.Float(math.sqrt(0.5))
"""Offset of the margins, which vanish at 270 degrees of rotation and 135 degrees of tilt."""


@dataclass(frozen=True)
class RelativeRotation:
    """Rotation from the axes of one marker to those of another, as a unit quaternion.

    The quaternion follows the bodies' motion without sign changes, so the angle is smooth past half a turn, up to a
    full turn. `scalar`: h, the cosine of half the angle. `vector`: v, the sine of half the angle along the rotation
    axis, in the first marker's axes (and the second's). In elements, the first marker is j, the second i.
    """

    scalar: sp.Expr
    vector: sp.Matrix

    @property
    def margin(self) -> sp.Expr:
        """Positive below 270 degrees; the rotation vector is undefined at 360 degrees."""
        return self.scalar + COSINE

    @cached_property
    def rotation(self) -> sp.Matrix:
        """Rotation vector: angle, rad, along the rotation axis."""
        return RotationVector(self.scalar, sp.Integer(0)) * self.vector

    def rates(self, half: sp.Matrix) -> list[sp.Expr]:
        """Return h' and v' for half the angular velocity w of the second marker relative to (and in axes of) the first.

        h' = -w.v/2 and v' = (h w + w x v)/2; Shuster, A survey of attitude representations, J. Astronautical Sciences
        41 (1993) 439-517.
        """
        return [-half.dot(self.vector), *(self.scalar * half + half.cross(self.vector))]

    def torque(self, moments: list[sp.Expr]) -> sp.Matrix:
        """Return the torque conjugate to the rates of the rotation vector (see `rates`), in the first marker's axes."""
        h, v, m = self.scalar, self.vector, sp.Matrix(moments)
        c, slope = (RotationVector(h, sp.Integer(order)) for order in (0, 1))
        return (c * (h * m + v.cross(m)) - slope * m.dot(v) * v) / 2


@dataclass(frozen=True)
class ShortestRotation:
    """Shortest rotation from an axis of one marker to that of another, independent of the rotation about the axis.

    `axis`: 0, 1 or 2 for x, y, z. `direction`: the second marker's axis in the first marker's axes. In elements, the
    first marker is j, the second i.
    """

    axis: int
    direction: sp.Matrix

    @property
    def margin(self) -> sp.Expr:
        """Positive below 135 degrees; the tilt direction is undefined at 180 degrees."""
        return self.direction[self.axis] + COSINE

    @cached_property
    def rotation(self) -> sp.Matrix:
        """Rotation vector, rad, without a component along the axis."""
        return RotationVector(self.direction[self.axis], sp.Integer(0)) / 2 * self._across

    @property
    def _across(self) -> sp.Matrix:
        """Sine of the tilt along the rotation axis."""
        return sp.eye(3)[:, self.axis].cross(self.direction)

    def torque(self, moments: list[sp.Expr]) -> sp.Matrix:
        """Return the torque conjugate to the rates of the rotation vector, in the first marker's axes.

        The direction n changes by w x n, so the torque is n x dP/dn' for the power P of the moments.
        """
        n, axis, m = self.direction, sp.eye(3)[:, self.axis], sp.Matrix(moments)
        c, slope = (RotationVector(n[self.axis], sp.Integer(order)) / 2 for order in (0, 1))
        return n.cross(c * m.cross(axis) + slope * m.dot(self._across) * axis)


def product(p: sp.Matrix, q: sp.Matrix) -> sp.Matrix:
    """Return the product of two quaternions, scalar first."""
    u, v = p[1:, :], q[1:, :]
    return sp.Matrix([p[0] * q[0] - u.dot(v), *(p[0] * v + q[0] * u + u.cross(v))])
