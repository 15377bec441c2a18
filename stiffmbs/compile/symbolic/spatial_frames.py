"""Spatial bodies and markers in SymPy.

A body's rotation matrix A is nine symbols, which kernels read; they are differentiated by small turns phi about the
ground's axes, dA = [dphi] A, so that no equation holds products of quaternions.  Each vector that is fixed in a body
has names for its parts in ground axes: its derivatives are its own parts, dv = dphi x v, at no cost whatever the vector
is.  The rate of phi is the angular velocity A w, whose parts have names as well.  Derivatives by the quaternion p
follow from dphi = E dp with E = 2 dp conj(p)/|p|^2, whose entries are e = 2 p/|p|^2 but for their signs.  A does not
depend on the length of p, nor does anything else.

Shabana, Dynamics of Multibody Systems (2013), sec. 2.3, 2.4.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from ..bodies import SPACE
from .differentiate import Derivatives, Way
from .relative_rotation import product

TURNS = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
"""An axis, and the two that a turn about it takes into each other."""


@dataclass(frozen=True)
class SpatialBodyFrame:
    """The coordinates q = (r, p), velocities u = (r', w) and accelerations a of one spatial body as symbols.

    w is the angular velocity in the body's principal axes, and `spin` that one of these, if any, about which p doesn't follow it.
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
        """Make known that a vector turns with the body: by a turn phi it changes by phi x vector."""
        parts = list(vector)
        changes: list[dict[sp.Symbol, sp.Expr]] = [{}, {}, {}]
        for about, first, second in TURNS:
            changes[first][self.phi[about]] = -parts[second]
            changes[second][self.phi[about]] = parts[first]
        for part, change, stands_for in zip(parts, changes, meaning, strict=True):
            self.derivatives.define(part, change, stands_for)

    def carried(self, vector: Iterable[sp.Expr]) -> sp.Matrix:
        """A vector that is given in the body's axes, in ground axes: names for its parts."""
        own = tuple(vector)
        if own not in self._carried:
            stem = f"carried{self.slot}_{len(self._carried)}"
            parts = sp.Matrix([sp.Symbol(f"{stem}_{k}", real=True) for k in range(3)])
            self._turning(parts, self.rotation * sp.Matrix(own))
            self._carried[own] = parts
        return self._carried[own]

    @cached_property
    def q(self) -> tuple[sp.Symbol, ...]:
        """Its coordinates: centre of mass and quaternion."""
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.positions)

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        """Its velocities: of the centre of mass, and angular along its own axes."""
        return tuple(sp.Symbol(f"{name}_{self.slot}", real=True) for name in SPACE.velocities)

    @cached_property
    def a(self) -> tuple[sp.Symbol, ...]:
        """The rates of its velocities."""
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

    @cached_property
    def _size(self) -> sp.Symbol:
        """The logarithm of n, which changes with p by -e: what is proportional to n is its own derivative by it."""
        return sp.Symbol(f"size_{self.slot}", real=True)

    @property
    def inverse_square(self) -> sp.Symbol:
        """2/|p|^2."""
        return self._n

    @cached_property
    def phi(self) -> tuple[sp.Symbol, ...]:
        """Small turns about the ground's axes."""
        return tuple(sp.Symbol(f"phi{k}_{self.slot}", real=True) for k in range(3))

    @property
    def turn(self) -> tuple[sp.Symbol, ...]:
        """A row by row, e and n, which kernels read."""
        return (*self.rotation, *self._e, self._n)

    @property
    def turn_stride(self) -> int:
        """Numbers in kernels' array `turn` for each body."""
        return SPACE.turn_stride

    @property
    def turned(self) -> dict[sp.Expr, sp.Symbol]:
        """Functions of the coordinates whose value kernels read: none."""
        return {}

    @cached_property
    def motion(self) -> list[tuple[sp.Symbol, sp.Expr]]:
        """By what a function of the pose changes in time, and how fast: its rate is the sum of derivative times rate."""
        turning = list(
            zip(self.q[3:], self.quaternion_rates(sp.Matrix(self.q[3:])) * sp.Matrix(self.followed), strict=True)
        )
        about_axes = zip(self.phi, self.carried(self.followed), strict=True)
        return [*zip(self.q[:3], self.u[:3], strict=True), *about_axes, *turning]

    @property
    def followed(self) -> list[sp.Expr]:
        """The angular velocity that the quaternion follows, in the principal axes."""
        return [sp.Integer(0) if axis == self.spin else w for axis, w in zip("xyz", self.u[3:], strict=True)]

    @staticmethod
    def quaternion_rates(p: sp.Matrix) -> sp.Matrix:
        """The matrix Z of p' = Z w = p w / 2."""
        p0, p1, p2, p3 = p
        return sp.Matrix([[-p1, -p2, -p3], [p0, -p3, p2], [p3, p0, -p1], [-p2, p1, p0]]) / 2

    @cached_property
    def by_coordinate(self) -> list[list[Way]]:
        """For each coordinate the symbols that change with it, and how much: dx/dq is the sum of derivative times that."""
        e0, e1, e2, e3 = self._e
        E = sp.Matrix([[-e1, e0, -e3, e2], [-e2, e3, e0, -e1], [-e3, -e2, e1, e0]])
        straight = [[(r, sp.Integer(1))] for r in self.q[:3]]
        turning = [
            [*((phi, E[k, j]) for k, phi in enumerate(self.phi)), (self._size, -self._e[j]), (p, sp.Integer(1))]
            for j, p in enumerate(self.q[3:])
        ]
        return straight + turning

    @cached_property
    def by_velocity(self) -> list[list[Way]]:
        """The same for each velocity: what moves with the body has the angular velocity in ground axes."""
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
        """The vectors in ground axes that have an angular velocity as a part in the principal axes."""
        vectors = [self.omega, *([self.carried(self.followed)] if self.spin else [])]
        return vectors if w in self.followed else vectors[:1]

    @property
    def pose(self) -> tuple[sp.Symbol, ...]:
        """By what functions of the pose are differentiated."""
        return (*self.q, *self.phi)

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """By what functions of the velocities are differentiated."""
        return (*self.u, *self.omega, *(self.carried(self.followed) if self.spin else ()))

    @property
    def vectors(self) -> dict[sp.Symbol, tuple[sp.Expr, ...]]:
        """Symbols that stand for parts of vectors of the body, and each vector in its own axes."""
        return {part: own for own, parts in self._carried.items() for part in parts}

    @property
    def bounded(self) -> tuple[sp.Symbol, ...]:
        """Symbols that are of order one at every pose."""
        return self.turn

    @property
    def origin(self) -> sp.Matrix:
        """The centre of mass."""
        return sp.Matrix(self.q[:3])

    @property
    def omega(self) -> sp.Matrix:
        """The angular velocity in ground axes."""
        return self.carried(self.u[3:])

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
        return self.body.origin + self.body.carried(self.numbers[:3])

    def _axis(self, k: int) -> sp.Matrix:
        return self.body.carried(self.numbers[3 + k : 12 : 3])

    @property
    def x(self) -> sp.Matrix:
        """Its x axis in ground axes."""
        return self._axis(0)

    @property
    def y(self) -> sp.Matrix:
        """Its y axis in ground axes."""
        return self._axis(1)

    @property
    def z(self) -> sp.Matrix:
        """Its z axis in ground axes."""
        return self._axis(2)

    @property
    def axes(self) -> list[sp.Matrix]:
        """Its three axes in ground axes."""
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
