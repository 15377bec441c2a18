"""The symbolic side of bodies and markers: what an element's equations are written in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from .spline import integral

COINCIDENT = sp.Float("1e-200")
"""Added under the root of a distance, so that a spring of no free length is defined where its points coincide."""


@dataclass(frozen=True)
class BodyFrame:
    """The coordinates q = (x, y, phi), velocities u = q' and accelerations a of one planar body as symbols."""

    slot: int

    @cached_property
    def q(self) -> tuple[sp.Symbol, ...]:
        return sp.symbols(f"x{self.slot} y{self.slot} phi{self.slot}", real=True)

    @cached_property
    def u(self) -> tuple[sp.Symbol, ...]:
        return sp.symbols(f"vx{self.slot} vy{self.slot} omega{self.slot}", real=True)

    @cached_property
    def a(self) -> tuple[sp.Symbol, ...]:
        return sp.symbols(f"ax{self.slot} ay{self.slot} alpha{self.slot}", real=True)

    @property
    def origin(self) -> sp.Matrix:
        return sp.Matrix(self.q[:2])

    @property
    def angle(self) -> sp.Symbol:
        return self.q[2]

    def coordinate(self, name: str) -> sp.Symbol:
        """The coordinate or velocity that a formula calls ``x``, ``angle``, ``omega`` ..."""
        return dict(zip(("x", "y", "angle", "vx", "vy", "omega"), (*self.q, *self.u), strict=True))[name]

    def rotated(self, along: sp.Expr, across: sp.Expr) -> sp.Matrix:
        """A vector of the body's own axes in ground axes, A(phi) s'."""
        c, s = sp.cos(self.angle), sp.sin(self.angle)
        return sp.Matrix([c * along - s * across, s * along + c * across])


MARKER_NUMBERS = ("xi", "eta", "angle", "cos", "sin")
"""A marker's numbers in a kernel: its point, its angle, and the angle's cosine and sine."""


@dataclass(frozen=True)
class Frame:
    """A marker as equations see it: point, direction and angle in ground axes."""

    body: BodyFrame
    numbers: tuple[sp.Symbol, ...]

    @property
    def point(self) -> sp.Matrix:
        """r + A(phi) s', m."""
        return self.body.origin + self.body.rotated(self.numbers[0], self.numbers[1])

    @property
    def angle(self) -> sp.Expr:
        return self.body.angle + self.numbers[2]

    @property
    def axis(self) -> sp.Matrix:
        """Unit vector along the marker's axis."""
        return self.body.rotated(self.numbers[3], self.numbers[4])

    @property
    def normal(self) -> sp.Matrix:
        """Unit vector across the marker's axis, a quarter turn ahead of it."""
        return self.body.rotated(-self.numbers[4], self.numbers[3])


class SymbolicElement:
    """An element with frames for its markers and symbols for its numbers.

    Attributes
    ----------
    t : sympy.Symbol
        Time.
    frames : list of BodyFrame
        The bodies, in the order of `Element.bodies`.
    """

    t = sp.Symbol("t", real=True)

    def __init__(self, frames: list[BodyFrame], fields: dict[str, object]) -> None:
        self.frames = frames
        self.__dict__.update(fields)

    @property
    def q(self) -> sp.Matrix:
        return sp.Matrix([symbol for frame in self.frames for symbol in frame.q])

    @property
    def u(self) -> sp.Matrix:
        return sp.Matrix([symbol for frame in self.frames for symbol in frame.u])

    @property
    def a(self) -> sp.Matrix:
        return sp.Matrix([symbol for frame in self.frames for symbol in frame.a])

    def rate(self, expression: sp.Expr) -> sp.Expr:
        """Total time derivative, with q' = u."""
        partial = sum((sp.diff(expression, q) * u for q, u in zip(self.q, self.u, strict=True)), sp.Integer(0))
        return partial + sp.diff(expression, self.t)

    def is_constant(self, expression: sp.Expr) -> bool:
        """Whether an expression depends on neither time nor the state."""
        return not ({self.t, *self.q, *self.u} & sp.sympify(expression).free_symbols)

    @staticmethod
    def distance(a: sp.Matrix, b: sp.Matrix) -> sp.Expr:
        """Distance of two points, with a derivative of zero where they coincide."""
        d = a - b
        return sp.sqrt(d.dot(d) + COINCIDENT)

    @staticmethod
    def integral(law: Callable[[sp.Expr], sp.Expr], x: sp.Expr) -> sp.Expr | None:
        """The integral of a law from 0 to x, for a potential; None where there is no simple one."""
        return integral(law, x)
