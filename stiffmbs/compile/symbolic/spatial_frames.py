"""Spatial bodies and markers in SymPy.

A body's rotation matrix A is nine symbols, shared by kernels. They are differentiated by small rotations phi about the
ground's axes, dA = [dphi] A, so equations contain no products of quaternions. Each body-fixed vector has named
components in ground axes with the derivative dv = dphi x v, which costs nothing. The rate of phi is the angular
velocity A w, with named components. Derivatives by the quaternion p follow from dphi = E dp with E = 2 dp
conj(p)/|p|^2, whose entries are e = 2 p/|p|^2 except for signs. Nothing depends on the length of p. Shabana, Dynamics
of Multibody Systems (2013), sec. 2.3, 2.4.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import sympy as sp

from ..bodies import SPACE
from .differentiate import Derivatives, Slope
from .relative_rotation import product

if TYPE_CHECKING:
    from .element import SymbolicElement


@dataclass(frozen=True)
class SpatialBodyFrame:
    """Coordinates q = (r, p), velocities u = (r', w) and accelerations a of one spatial body as symbols.

    w is the angular velocity in principal axes, and `spin` the axis, if any, about which p does not follow it.
    """

    slot: int
    derivatives: Derivatives = field(compare=False)
    spin: str = ""
    _carried: dict[tuple[sp.Expr, ...], sp.Matrix] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        for axis in range(3):
            self._turning(self.rotation[:, axis])
        for e, p in zip(self._e, self.q[3:], strict=True):
            self.derivatives.define(e, {p: self._n, self._size: e})
        self.derivatives.define(self._n, {self._size: self._n})

    def _turning(self, vector: Iterable[sp.Symbol], meaning: Iterable[sp.Expr | None] = (None,) * 3) -> None:
        """Define the derivatives of a body-fixed vector: a rotation phi changes it by phi x vector."""
        parts = list(vector)
        changes: list[dict[sp.Symbol, sp.Expr]] = [{}, {}, {}]
        for about, first, second in ((k, (k + 1) % 3, (k + 2) % 3) for k in range(3)):
            changes[first][self.phi[about]] = -parts[second]
            changes[second][self.phi[about]] = parts[first]
        for part, change, stands_for in zip(parts, changes, meaning, strict=True):
            self.derivatives.define(part, change, stands_for)

    def carried(self, vector: Iterable[sp.Expr]) -> sp.Matrix:
        """Return named components in ground axes of a vector given in body axes."""
        own = tuple(vector)
        if own not in self._carried:
            stem = f"carried{self.slot}_{len(self._carried)}"
            parts = sp.Matrix([sp.Symbol(f"{stem}_{k}", real=True) for k in range(3)])
            self._turning(parts, self.rotation * sp.Matrix(own))
            self._carried[own] = parts
        return self._carried[own]

    @cached_property
    def q(self) -> tuple[sp.Symbol, ...]:
        """Coordinates: centre of mass and quaternion."""
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.positions)

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        """Velocities: of the centre of mass, and angular in body axes."""
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.velocities)

    @cached_property
    def a(self) -> tuple[sp.Symbol, ...]:
        """Accelerations."""
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.accelerations)

    @cached_property
    def rotation(self) -> sp.Matrix:
        """Rotation matrix A: its columns are the body's axes in ground axes."""
        return sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"a{i}{j}_{self.slot}", real=True))

    @cached_property
    def _e(self) -> tuple[sp.Symbol, ...]:
        return tuple(sp.Symbol(f"e{k}_{self.slot}", real=True) for k in range(4))

    @cached_property
    def _n(self) -> sp.Symbol:
        return sp.Symbol(f"n_{self.slot}", real=True)

    @cached_property
    def _size(self) -> sp.Symbol:
        """Logarithm of n, with derivative -e by p: quantities proportional to n are their own derivatives by it."""
        return sp.Symbol(f"size_{self.slot}", real=True)

    @property
    def inverse_square(self) -> sp.Symbol:
        """2/|p|^2."""
        return self._n

    @cached_property
    def phi(self) -> tuple[sp.Symbol, ...]:
        """Small rotations about the ground's axes."""
        return tuple(sp.Symbol(f"phi{k}_{self.slot}", real=True) for k in range(3))

    @property
    def turn(self) -> tuple[sp.Symbol, ...]:
        """A by rows, e and n, shared by kernels."""
        return (*self.rotation, *self._e, self._n)

    @property
    def turn_stride(self) -> int:
        """Entries of the kernels' array `turn` per coordinate."""
        return SPACE.turn_stride

    @property
    def turned(self) -> dict[sp.Expr, sp.Symbol]:
        """Functions of the coordinates whose shared values kernels read: none."""
        return {}

    @cached_property
    def motion(self) -> list[tuple[sp.Symbol, sp.Expr]]:
        """Symbols of the pose with their rates: the rate of a function is the sum of derivative times rate."""
        turning = list(
            zip(self.q[3:], self.quaternion_rates(sp.Matrix(self.q[3:])) * sp.Matrix(self.followed), strict=True)
        )
        about_axes = zip(self.phi, self.carried(self.followed), strict=True)
        return [*zip(self.q[:3], self.u[:3], strict=True), *about_axes, *turning]

    @property
    def followed(self) -> list[sp.Expr]:
        """Angular velocity that the quaternion follows, in the principal axes."""
        return [sp.Integer(0) if axis == self.spin else w for axis, w in zip("xyz", self.u[3:], strict=True)]

    @staticmethod
    def quaternion_rates(p: sp.Matrix) -> sp.Matrix:
        """Return the matrix Z of p' = Z w = p w / 2."""
        p0, p1, p2, p3 = p
        return sp.Matrix([[-p1, -p2, -p3], [p0, -p3, p2], [p3, p0, -p1], [-p2, p1, p0]]) / 2

    @cached_property
    def by_coordinate(self) -> list[list[Slope]]:
        """Symbols that depend on each coordinate, with their derivatives."""
        e0, e1, e2, e3 = self._e
        E = sp.Matrix([[-e1, e0, -e3, e2], [-e2, e3, e0, -e1], [-e3, -e2, e1, e0]])
        straight = [[(r, sp.Integer(1))] for r in self.q[:3]]
        turning = [
            [*((phi, E[k, j]) for k, phi in enumerate(self.phi)), (self._size, -self._e[j]), (p, sp.Integer(1))]
            for j, p in enumerate(self.q[3:])
        ]
        return straight + turning

    @cached_property
    def by_velocity(self) -> list[list[Slope]]:
        """Symbols that depend on each velocity, with their derivatives."""
        straight = [[(v, sp.Integer(1))] for v in self.u[:3]]
        turning = [
            [
                *((part, self.rotation[k, j]) for parts in self._turning_with(w) for k, part in enumerate(parts)),
                (w, sp.Integer(1)),
            ]
            for j, w in enumerate(self.u[3:])
        ]
        return straight + turning

    def _turning_with(self, w: sp.Symbol) -> list[sp.Matrix]:
        """Return the angular velocity vectors in ground axes that contain a principal component."""
        vectors = [self.omega, *([self.carried(self.followed)] if self.spin else [])]
        return vectors if w in self.followed else vectors[:1]

    @property
    def pose(self) -> tuple[sp.Symbol, ...]:
        """Symbols by which functions of the pose are differentiated."""
        return (*self.q, *self.phi)

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """Symbols by which functions of the velocities are differentiated."""
        return (*self.u, *self.omega, *(self.carried(self.followed) if self.spin else ()))

    @property
    def vectors(self) -> dict[sp.Symbol, tuple[sp.Expr, ...]]:
        """Symbols for components of body-fixed vectors, with each vector in body axes."""
        return {part: own for own, parts in self._carried.items() for part in parts}

    @property
    def bounded(self) -> tuple[sp.Symbol, ...]:
        """Symbols of order one at every pose."""
        return self.turn

    @property
    def origin(self) -> sp.Matrix:
        """Centre of mass."""
        return sp.Matrix(self.q[:3])

    @property
    def omega(self) -> sp.Matrix:
        """Angular velocity in ground axes."""
        return self.carried(self.u[3:])

    def coordinate(self, name: str) -> sp.Symbol:
        """Return the coordinate or velocity by its name in formulas: ``x``, ``vy`` ..."""
        return dict(zip((*SPACE.positions[:3], *SPACE.velocities[:3]), (*self.q[:3], *self.u[:3]), strict=True))[name]

    def wrench(self, effort: sp.Matrix, point: sp.Matrix) -> sp.Matrix:
        """Return force and torque about a point from a generalised force on the body, in ground axes."""
        force, torque = effort[:3, :], self.rotation * effort[3:, :]
        return sp.Matrix([*force, *(torque - (point - self.origin).cross(force))])


MARKER_NUMBERS = (
    *(f"s{k}" for k in range(3)), *(f"b{i}{j}" for i in range(3) for j in range(3)), *(f"o{k}" for k in range(4))
)  # fmt: skip
"""Marker numbers in a kernel: point, rotation matrix, and quaternion, all in the body's principal axes."""


@dataclass(frozen=True)
class SpatialFrame:
    """Marker in equations: point, axes and angular velocity, in ground axes."""

    body: SpatialBodyFrame
    numbers: tuple[sp.Symbol, ...]

    @property
    def point(self) -> sp.Matrix:
        """Position r + A s', m."""
        return self.body.origin + self.body.carried(self.numbers[:3])

    def _axis(self, k: int) -> sp.Matrix:
        return self.body.carried(self.numbers[3 + k : 12 : 3])

    @property
    def x(self) -> sp.Matrix:
        """x axis in ground axes."""
        return self._axis(0)

    @property
    def y(self) -> sp.Matrix:
        """y axis in ground axes."""
        return self._axis(1)

    @property
    def z(self) -> sp.Matrix:
        """z axis in ground axes."""
        return self._axis(2)

    @property
    def axes(self) -> list[sp.Matrix]:
        """The three axes in ground axes."""
        return [self.x, self.y, self.z]

    def angle_about(self, axis: str, other: SpatialFrame, e: SymbolicElement) -> sp.Expr:
        """Return the continuous angle relative to another marker about that marker's axis, rad."""
        match axis:
            case "x":
                return e.angle(-self.z.dot(other.y), self.z.dot(other.z))
            case "y":
                return e.angle(self.z.dot(other.x), self.z.dot(other.z))
        return e.angle(self.x.dot(other.y), self.x.dot(other.x))

    @property
    def omega(self) -> sp.Matrix:
        """Angular velocity of the body."""
        return self.body.omega

    @property
    def own_omega(self) -> sp.Matrix:
        """Angular velocity of the body in the marker's axes."""
        w = sp.Matrix(self.body.u[3:])
        return sp.Matrix([sp.Matrix(self.numbers[3 + k : 12 : 3]).dot(w) for k in range(3)])

    @property
    def quaternion(self) -> sp.Matrix:
        """Quaternion of the marker's axes in ground axes, with the length of the body's."""
        return product(sp.Matrix(self.body.q[3:]), sp.Matrix(self.numbers[12:]))
