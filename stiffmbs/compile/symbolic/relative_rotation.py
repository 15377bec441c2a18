"""How one orientation is turned against another: rotation vector, twist, and the torques that do work on them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import sympy as sp


class RotationVector(sp.Function):  # type: ignore[misc]
    """A derivative of the function that makes a rotation vector of a quaternion's vector part: Unwound(h, order)."""

    nargs = 2
    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        h, order = self.args
        return RotationVector(h, order + 1)


COSINE = sp.Float(math.sqrt(0.5))
"""Of half the angle that three quarters of a turn lack to a full one, and of the angle that a tilt may lack to half a turn."""


@dataclass(frozen=True)
class RelativeRotation:
    """The rotation that takes the axes of one marker into those of another, as a unit quaternion.

    The quaternion is that of the bodies' motion, which knows whole turns: its angle goes on smoothly past half a turn,
    to a full turn, where the next one begins.

    Attributes
    ----------
    scalar : Expr
        h, the cosine of half the angle.
    vector : Matrix
        v, the sine of half the angle along the axis of rotation, in the first marker's axes (and the second's).
    """

    scalar: sp.Expr
    vector: sp.Matrix

    @property
    def margin(self) -> sp.Expr:
        """Above zero up to three quarters of a turn, a quarter before the rotation vector has no direction."""
        return self.scalar + COSINE

    @cached_property
    def rotation(self) -> sp.Matrix:
        """The rotation vector: the angle, rad, along the axis of rotation."""
        return RotationVector(self.scalar, sp.Integer(0)) * self.vector

    def rates(self, half: sp.Matrix) -> list[sp.Expr]:
        """h' and v' for half the angular velocity w of the second marker against the first, in the first one's axes.

        h' = -w.v/2 and v' = (h w + w x v)/2; Shuster, A survey of attitude representations, J. Astronautical Sciences 41
        (1993) 439-517.
        """
        return [-half.dot(self.vector), *(self.scalar * half + half.cross(self.vector))]

    def torque(self, moments: list[sp.Expr]) -> sp.Matrix:
        """The torque with the power that moments have with the rates of the rotation vector, in the first marker's axes.

        It follows from `rates`; Shuster, A survey of attitude representations, J. Astronautical Sciences 41 (1993) 439-517.
        """
        h, v, m = self.scalar, self.vector, sp.Matrix(moments)
        c, slope = (RotationVector(h, sp.Integer(order)) for order in (0, 1))
        return (c * (h * m + v.cross(m)) - slope * m.dot(v) * v) / 2


@dataclass(frozen=True)
class ShortestRotation:
    """The shortest rotation that takes an axis of one marker into that of another, whatever the turn about the axis is.

    Attributes
    ----------
    axis : int
        0, 1 or 2 for x, y, z.
    direction : Matrix
        The second marker's axis in the first marker's axes.
    """

    axis: int
    direction: sp.Matrix

    @property
    def margin(self) -> sp.Expr:
        """Above zero up to 135 degrees, 45 before the tilt has no direction."""
        return self.direction[self.axis] + COSINE

    @cached_property
    def rotation(self) -> sp.Matrix:
        """The rotation vector, rad, without a part along the axis."""
        return RotationVector(self.direction[self.axis], sp.Integer(0)) / 2 * self._across

    @property
    def _across(self) -> sp.Matrix:
        """The sine of the tilt along the axis of rotation."""
        return sp.eye(3)[:, self.axis].cross(self.direction)

    def torque(self, moments: list[sp.Expr]) -> sp.Matrix:
        """The torque with the power that moments have with the rates of the rotation vector, in the first marker's axes.

        The direction n changes by w x n, so that the torque is n x dP/dn' for the power P of the moments.
        """
        n, axis, m = self.direction, sp.eye(3)[:, self.axis], sp.Matrix(moments)
        c, slope = (RotationVector(n[self.axis], sp.Integer(order)) / 2 for order in (0, 1))
        return n.cross(c * m.cross(axis) + slope * m.dot(self._across) * axis)


def product(p: sp.Matrix, q: sp.Matrix) -> sp.Matrix:
    """The product of two quaternions, scalar first."""
    u, v = p[1:, :], q[1:, :]
    return sp.Matrix([p[0] * q[0] - u.dot(v), *(p[0] * v + q[0] * u + u.cross(v))])
