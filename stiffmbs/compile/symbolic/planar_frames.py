"""Planar bodies and markers in SymPy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from ..bodies import PLANE
from .differentiate import Slope


@dataclass(frozen=True)
class BodyFrame:
    """Coordinates q = (x, y, phi), velocities u = q' and accelerations a of one planar body as symbols."""

    slot: int

    @cached_property
    def q(self) -> tuple[sp.Symbol, ...]:
        """Coordinates."""
        return sp.symbols(f"x{self.slot} y{self.slot} phi{self.slot}", real=True)

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        """Velocities."""
        return sp.symbols(f"vx{self.slot} vy{self.slot} omega{self.slot}", real=True)

    @cached_property
    def a(self) -> tuple[sp.Symbol, ...]:
        """Accelerations."""
        return sp.symbols(f"ax{self.slot} ay{self.slot} alpha{self.slot}", real=True)

    @cached_property
    def turn(self) -> tuple[sp.Symbol, ...]:
        """Cosine and sine of the angle, shared by kernels."""
        return sp.symbols(f"cos{self.slot} sin{self.slot}", real=True)

    @property
    def turned(self) -> dict[sp.Expr, sp.Symbol]:
        """Functions of the coordinates whose shared values kernels read."""
        return dict(zip((sp.cos(self.angle), sp.sin(self.angle)), self.turn, strict=True))

    @property
    def turn_stride(self) -> int:
        """Entries of the kernels' array `turn` per coordinate."""
        return PLANE.turn_stride

    @property
    def motion(self) -> list[tuple[sp.Symbol, sp.Expr]]:
        """Symbols of the pose with their rates: the rate of a function is the sum of derivative times rate."""
        return list(zip(self.q, self.u, strict=True))

    @property
    def by_coordinate(self) -> list[list[Slope]]:
        """Symbols that depend on each coordinate, with their derivatives."""
        return [[(q, sp.Integer(1))] for q in self.q]

    @property
    def by_velocity(self) -> list[list[Slope]]:
        """Symbols that depend on each velocity, with their derivatives."""
        return [[(u, sp.Integer(1))] for u in self.u]

    @property
    def pose(self) -> tuple[sp.Symbol, ...]:
        """Symbols by which functions of the pose are differentiated."""
        return self.q

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """Symbols by which functions of the velocities are differentiated."""
        return self.u

    @property
    def vectors(self) -> dict[sp.Symbol, tuple[sp.Expr, ...]]:
        """Symbols for components of body-fixed vectors, with each vector in body axes: none."""
        return {}

    @property
    def bounded(self) -> tuple[sp.Symbol, ...]:
        """Symbols of order one at every pose: none."""
        return ()

    @property
    def origin(self) -> sp.Matrix:
        """Centre of mass in ground axes, m."""
        return sp.Matrix(self.q[:2])

    @property
    def angle(self) -> sp.Symbol:
        """Angle phi, rad."""
        return self.q[2]

    def coordinate(self, name: str) -> sp.Symbol:
        """Return the coordinate or velocity by its name in formulas: ``x``, ``angle``, ``omega`` ..."""
        return dict(zip(("x", "y", "angle", "vx", "vy", "omega"), (*self.q, *self.u), strict=True))[name]

    def rotated(self, along: sp.Expr, across: sp.Expr) -> sp.Matrix:
        """Return a vector in body axes in ground axes, A(phi) s'."""
        c, s = sp.cos(self.angle), sp.sin(self.angle)
        return sp.Matrix([c * along - s * across, s * along + c * across])

    def wrench(self, effort: sp.Matrix, point: sp.Matrix) -> sp.Matrix:
        """Return force and torque about a point from a generalised force on the body, in ground axes."""
        fx, fy, moment = effort
        arm = point - self.origin
        return sp.Matrix([fx, fy, moment - arm[0] * fy + arm[1] * fx])


MARKER_NUMBERS = ("xi", "eta", "angle", "cos", "sin")
"""Marker numbers in a kernel: point, angle, and the angle's cosine and sine."""


@dataclass(frozen=True)
class Frame:
    """Marker in equations: point, direction and angle in ground axes."""

    body: BodyFrame
    numbers: tuple[sp.Symbol, ...]

    @property
    def point(self) -> sp.Matrix:
        """Position r + A(phi) s', m."""
        return self.body.origin + self.body.rotated(self.numbers[0], self.numbers[1])

    @property
    def angle(self) -> sp.Expr:
        """Angle in ground axes, rad."""
        return self.body.angle + self.numbers[2]

    @property
    def axes(self) -> list[sp.Matrix]:
        """Direction and its normal in ground axes."""
        return [self.axis, self.normal]

    def angle_about(self, axis: str, other: Frame, e: object) -> sp.Expr:
        """Return the angle relative to another marker about the plane's normal, rad."""
        return self.angle - other.angle

    @property
    def axis(self) -> sp.Matrix:
        """Unit vector along the marker's axis."""
        return self.body.rotated(self.numbers[3], self.numbers[4])

    @property
    def normal(self) -> sp.Matrix:
        """Unit vector normal to the marker's axis, rotated by +90 degrees."""
        return self.body.rotated(-self.numbers[4], self.numbers[3])
