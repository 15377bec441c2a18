"""Logarithm of the rigid displacement between two markers, for beam elements: SE(3) in space, SE(2) in the plane.

The displacement is d, the position of marker i from marker j, with the rotation of i's axes against j's, both in j's
axes. Its logarithm (u, theta) is the screw that a body moves along with constant strain: theta is the rotation vector
and d = T(theta) u. Selig, Geometric Fundamentals of Robotics (2005), ch. 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy as sp

from .relative_rotation import COSINE, RelativeRotation, RotationVector

if TYPE_CHECKING:
    from .element import SymbolicElement
    from .spatial_frames import SpatialFrame


@dataclass(frozen=True)
class SpatialLogarithm:
    """Logarithm in space; c = RotationVector(h) of the relative quaternion (h, v).

    u = d - c/2 v x d - c'/2 v x (v x d), as (1 - (theta/2) cot(theta/2))/theta^2 c^2 = -c'/2. `d`: position of marker i
    from marker j. `velocity`, `omega`: velocity of i's point relative to j's body, and relative angular velocity. `e`:
    for names.
    """

    d: sp.Matrix
    turn: RelativeRotation
    velocity: sp.Matrix
    omega: sp.Matrix
    e: SymbolicElement

    @cached_property
    def vector(self) -> list[sp.Expr]:
        """u, m, and theta, rad."""
        c, slope, _ = self._factors
        u = self.d - c / 2 * self._across - slope / 2 * self._twice_across
        return self.e.named([*u, *(c * self.turn.vector)])  # type: ignore[no-any-return]

    @cached_property
    def rates(self) -> list[sp.Expr]:
        """Rates of `vector`."""
        c, slope, second = self._factors
        v, d, moved = self.turn.vector, self.d, self.velocity
        h_rate, *parts = self.e.named(self.turn.rates(self.omega / 2))
        v_rate = sp.Matrix(parts)
        across = self.e.named(v_rate.cross(d) + v.cross(moved))
        twice = self.e.named(v_rate.cross(self._across) + v.cross(across))
        u = (
            moved
            - c / 2 * across
            - slope / 2 * twice
            - h_rate / 2 * (slope * self._across + second * self._twice_across)
        )
        return self.e.named([*u, *(c * v_rate + slope * h_rate * v)])  # type: ignore[no-any-return]

    def conjugate(self, stresses: list[sp.Expr]) -> list[sp.Expr]:
        """Return force and torque on marker i, conjugate to `velocity` and `omega`, from those on the rates."""
        c, slope, second = self._factors
        h, v, d = self.turn.scalar, self.turn.vector, self.d
        n, m = sp.Matrix(stresses[:3]), sp.Matrix(stresses[3:])
        v_n, twice = self.e.named(v.cross(n)), self._twice_across
        by_h = self.e.named(slope * m.dot(v) - slope / 2 * n.dot(self._across) - second / 2 * n.dot(twice))
        of_twice = n * v.dot(d) + d * n.dot(v) - 2 * n.dot(d) * v
        by_v = self.e.named(c * m - c / 2 * d.cross(n) - slope / 2 * of_twice)
        force = n + c / 2 * v_n - slope / 2 * v.cross(v_n)
        return self.e.named([*force, *((h * by_v + v.cross(by_v) - by_h * v) / 2)])  # type: ignore[no-any-return]

    @property
    def margin(self) -> sp.Expr:
        """Positive below 270 degrees."""
        return self.turn.margin

    @cached_property
    def _across(self) -> sp.Matrix:
        return self.e.named(self.turn.vector.cross(self.d))  # type: ignore[no-any-return]

    @cached_property
    def _twice_across(self) -> sp.Matrix:
        return self.e.named(self.turn.vector.cross(self._across))  # type: ignore[no-any-return]

    @cached_property
    def _factors(self) -> list[sp.Expr]:
        return self.e.named([RotationVector(self.turn.scalar, sp.Integer(k)) for k in range(3)])  # type: ignore[no-any-return]


@dataclass(frozen=True)
class PlanarLogarithm:
    """Logarithm in the plane: u = (k x + theta/2 y, k y - theta/2 x), k = (theta/2) cot(theta/2), for d = (x, y).

    `d`: position of marker i from marker j. `angle`: theta. `e`: for names and rates.
    """

    d: list[sp.Expr]
    angle: sp.Expr
    e: SymbolicElement

    @cached_property
    def vector(self) -> list[sp.Expr]:
        """u, m, and theta, rad."""
        (x, y), (k, _), half = self.d, self._factors, self.angle / 2
        return self.e.named([k * x + half * y, k * y - half * x, self.angle])  # type: ignore[no-any-return]

    @cached_property
    def rates(self) -> list[sp.Expr]:
        """Rates of `vector`."""
        (k, _), half = self._factors, self.angle / 2
        (x, y), (omega,) = self.velocity, self.omega
        along, across = self._by_angle
        return self.e.named([k * x + half * y + along * omega, k * y - half * x + across * omega, omega])  # type: ignore[no-any-return]

    @cached_property
    def velocity(self) -> list[sp.Expr]:
        """Rates of `d`."""
        return [self.e.named(self.e.rate(part)) for part in self.d]

    @cached_property
    def omega(self) -> list[sp.Expr]:
        """Rate of `angle`."""
        return [self.e.named(self.e.rate(self.angle))]

    def conjugate(self, stresses: list[sp.Expr]) -> list[sp.Expr]:
        """Return force and moment on marker i, conjugate to `velocity` and `omega`, from those on the rates."""
        (n1, n2, m), (k, _), half = stresses, self._factors, self.angle / 2
        along, across = self._by_angle
        return self.e.named([k * n1 - half * n2, half * n1 + k * n2, m + n1 * along + n2 * across])  # type: ignore[no-any-return]

    @property
    def margin(self) -> sp.Expr:
        """Positive below 270 degrees."""
        return self.e.named(sp.cos(self.angle / 2)) + COSINE

    @cached_property
    def _by_angle(self) -> tuple[sp.Expr, sp.Expr]:
        """Derivatives of u by the angle."""
        (x, y), (_, slope) = self.d, self._factors
        return self.e.named(slope * x + y / 2), self.e.named(slope * y - x / 2)

    @cached_property
    def _factors(self) -> tuple[sp.Expr, sp.Expr]:
        """k, and its derivative by the angle."""
        h = self.e.named(sp.cos(self.angle / 2))
        c, slope = (self.e.named(RotationVector(h, sp.Integer(order))) for order in range(2))
        return self.e.named(h * c / 2), self.e.named(-sp.sin(self.angle / 2) * (c + h * slope) / 4)


def logarithm(e: Any, i: Any, j: Any) -> SpatialLogarithm | PlanarLogarithm:
    """Return the logarithm of the displacement of marker i from marker j."""
    away = e.named(i.point - j.point)
    d = e.named([away.dot(axis) for axis in j.axes])
    if len(d) == 2:
        return PlanarLogarithm(d, e.named(i.angle - j.angle), e)
    v, w = (sp.Matrix(e.named([part.dot(axis) for axis in j.axes])) for part in map(e.named, relative_motion(e, i, j)))
    return SpatialLogarithm(sp.Matrix(d), e.relative_rotation(i, j), v, w, e)


def relative_motion(e: SymbolicElement, i: SpatialFrame, j: SpatialFrame) -> tuple[sp.Matrix, sp.Matrix]:
    """Return the velocity of i's point relative to j's body, and the relative angular velocity, in ground axes."""
    carried = e.rate(j.body.origin) + j.omega.cross(i.point - j.body.origin)
    return e.rate(i.point) - carried, i.omega - j.omega
