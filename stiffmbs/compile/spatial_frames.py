"""Spatial bodies and markers in SymPy.

A body's rotation matrix A is nine symbols, which kernels read; they are differentiated by small turns theta about the
body's axes, dA = A [dtheta], so that A' = A [w] and no equation holds products of quaternions.  Derivatives by the
quaternion p follow from dtheta = E dp with E = 2 conj(p) dp/|p|^2, whose entries are e = 2 p/|p|^2 but for their signs.
A does not depend on the length of p, nor does anything else.

Shabana, Dynamics of Multibody Systems (2013), sec. 2.3, 2.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from .bodies import SPACE
from .differentiate import Chain
from .turns import product

TURNS = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
"""An axis, and the two that a turn about it takes into each other."""


@dataclass(frozen=True)
class SpatialBodyFrame:
    """The coordinates q = (r, p), velocities u = (r', w) and accelerations a of one spatial body as symbols.

    w is the angular velocity in the body's principal axes.
    """

    slot: int

    @cached_property
    def q(self) -> tuple[sp.Symbol, ...]:
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.positions)

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.velocities)

    @cached_property
    def a(self) -> tuple[sp.Symbol, ...]:
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.accelerations)

    @cached_property
    def rotation(self) -> sp.Matrix:
        """A: its columns are the body's axes in ground axes."""
        return sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"a{i}{j}_{self.slot}", real=True))

    @cached_property
    def _e(self) -> tuple[sp.Symbol, ...]:
        return tuple(sp.Symbol(f"e{k}_{self.slot}", real=True) for k in range(4))

    @cached_property
    def _n(self) -> sp.Symbol:
        return sp.Symbol(f"n_{self.slot}", real=True)

    @property
    def inverse_square(self) -> sp.Symbol:
        """2/|p|^2."""
        return self._n

    @cached_property
    def _theta(self) -> tuple[sp.Symbol, ...]:
        return tuple(sp.Symbol(f"theta{k}_{self.slot}", real=True) for k in range(3))

    @property
    def turn(self) -> tuple[sp.Symbol, ...]:
        """A row by row, e and n, which kernels read."""
        return (*self.rotation, *self._e, self._n)

    @property
    def turn_stride(self) -> int:
        return SPACE.turn_stride

    @property
    def turned(self) -> dict[sp.Expr, sp.Symbol]:
        return {}

    @cached_property
    def chain(self) -> Chain:
        rotation, p = self.rotation, self.q[3:]
        chain: dict[sp.Symbol, dict[sp.Symbol, sp.Expr]] = {}
        for row in range(3):
            for about, first, second in TURNS:
                chain.setdefault(rotation[row, first], {})[self._theta[about]] = rotation[row, second]
                chain.setdefault(rotation[row, second], {})[self._theta[about]] = -rotation[row, first]
        for i, e in enumerate(self._e):
            chain[e] = {p[j]: (self._n if i == j else 0) - e * self._e[j] for j in range(4)}
        chain[self._n] = {p[j]: -self._n * self._e[j] for j in range(4)}
        return chain

    @cached_property
    def motion(self) -> list[tuple[sp.Symbol, sp.Expr]]:
        """By what a function of the pose changes in time, and how fast: its rate is the sum of derivative times rate."""
        p, w = sp.Matrix(self.q[3:]), sp.Matrix(self.u[3:])
        turning = list(zip(self.q[3:], self.quaternion_rates(p) * w, strict=True))
        return [*zip(self.q[:3], self.u[:3], strict=True), *zip(self._theta, w, strict=True), *turning]

    @staticmethod
    def quaternion_rates(p: sp.Matrix) -> sp.Matrix:
        """The matrix Z of p' = Z w = p w / 2."""
        p0, p1, p2, p3 = p
        return sp.Matrix([[-p1, -p2, -p3], [p0, -p3, p2], [p3, p0, -p1], [-p2, p1, p0]]) / 2

    @cached_property
    def by_coordinate(self) -> list[list[tuple[sp.Symbol, sp.Expr]]]:
        """For each coordinate the symbols that change with it, and how much: dx/dq is the sum of derivative times that."""
        e0, e1, e2, e3 = self._e
        E = sp.Matrix([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])
        straight = [[(r, sp.Integer(1))] for r in self.q[:3]]
        turning = [
            [*((theta, E[k, j]) for k, theta in enumerate(self._theta)), (p, sp.Integer(1))]
            for j, p in enumerate(self.q[3:])
        ]
        return straight + turning

    @property
    def origin(self) -> sp.Matrix:
        """The centre of mass."""
        return sp.Matrix(self.q[:3])

    @property
    def omega(self) -> sp.Matrix:
        """The angular velocity in ground axes."""
        return self.rotation * sp.Matrix(self.u[3:])

    def coordinate(self, name: str) -> sp.Symbol:
        """The coordinate or velocity that a formula calls ``x``, ``vy`` ..."""
        return dict(zip((*SPACE.positions[:3], *SPACE.velocities[:3]), (*self.q[:3], *self.u[:3]), strict=True))[name]

    def wrench(self, effort: sp.Matrix, point: sp.Matrix) -> sp.Matrix:
        """Force, and torque about a point, of a generalised force on the body, in ground axes."""
        force, torque = effort[:3, :], self.rotation * effort[3:, :]
        return sp.Matrix([*force, *(torque - (point - self.origin).cross(force))])


MARKER_NUMBERS = (
    *(f"s{k}" for k in range(3)), *(f"b{i}{j}" for i in range(3) for j in range(3)), *(f"o{k}" for k in range(4))
)  # fmt: skip
"""A marker's numbers in a kernel: its point, its rotation matrix, and its quaternion, all in the body's principal axes."""


@dataclass(frozen=True)
class SpatialFrame:
    """A marker as equations see it: point, axes and angular velocity, in ground axes."""

    body: SpatialBodyFrame
    numbers: tuple[sp.Symbol, ...]

    @property
    def point(self) -> sp.Matrix:
        """r + A s', m."""
        return self.body.origin + self.body.rotation * sp.Matrix(self.numbers[:3])

    def _axis(self, k: int) -> sp.Matrix:
        return self.body.rotation * sp.Matrix(self.numbers[3 + k : 12 : 3])

    @property
    def x(self) -> sp.Matrix:
        return self._axis(0)

    @property
    def y(self) -> sp.Matrix:
        return self._axis(1)

    @property
    def z(self) -> sp.Matrix:
        return self._axis(2)

    @property
    def axes(self) -> list[sp.Matrix]:
        return [self.x, self.y, self.z]

    def angle_about(self, axis: str, other: SpatialFrame, e: Any) -> sp.Expr:
        """The angle turned from another marker about that one's axis, rad, whole turns counted."""
        match axis:
            case "x":
                return e.angle(-self.z.dot(other.y), self.z.dot(other.z))
            case "y":
                return e.angle(self.z.dot(other.x), self.z.dot(other.z))
        return e.angle(self.x.dot(other.y), self.x.dot(other.x))

    @property
    def omega(self) -> sp.Matrix:
        """The body's angular velocity."""
        return self.body.omega

    @property
    def own_omega(self) -> sp.Matrix:
        """The body's angular velocity in the marker's axes."""
        w = sp.Matrix(self.body.u[3:])
        return sp.Matrix([sp.Matrix(self.numbers[3 + k : 12 : 3]).dot(w) for k in range(3)])

    @property
    def quaternion(self) -> sp.Matrix:
        """Of the marker's axes in ground axes; as long as the body's is."""
        return product(sp.Matrix(self.body.q[3:]), sp.Matrix(self.numbers[12:]))
