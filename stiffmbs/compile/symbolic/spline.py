"""Tables in equations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

import sympy as sp

from ...errors import InputError


class Spline(sp.Function):  # type: ignore[misc]
    """Value, or a derivative, of the table at an offset: Spline(x, offset, order); order -1 is its integral."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        x, table, order = self.args
        return Spline(x, table, order + 1) if order < 3 else sp.Integer(0)


def integral(law: Callable[[sp.Expr], sp.Expr], x: sp.Expr) -> sp.Expr | None:
    """Return the integral of a law from 0 to x: exact for tables and polynomials, None for other formulas."""
    s = sp.Dummy("s", real=True)
    value = law(s)
    if isinstance(value, Spline):
        _, table, _ = value.args
        return Spline(x, table, sp.Integer(-1)) - Spline(sp.Integer(0), table, sp.Integer(-1))
    if not value.is_polynomial(s):
        return None
    return sp.Poly(value, s).integrate(s).as_expr().subs(s, x)


class CommonNormal(sp.Function):  # type: ignore[misc]
    """Component of the unit normal in the axes of the second solid: CommonNormal(component, pose...)."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        component, *pose = self.args
        normal = (CommonNormal(sp.Integer(k), *pose) for k in range(3))
        return CommonNormalSlope(component, sp.Integer(argindex - 2), *normal, *pose)


class CommonNormalSlope(sp.Function):  # type: ignore[misc]
    """Derivative of the normal by an entry of the pose: CommonNormalSlope(component, entry, normal..., pose...)."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        raise InputError(
            "found a second derivative of the normal of two solids, expected it in efforts, and not in rates"
        )


def common_normal(
    offset: Sequence[sp.Expr],
    axes: Sequence[sp.Expr],
    first: Sequence[Sequence[sp.Expr]],
    second: Sequence[Sequence[sp.Expr]],
) -> sp.Matrix:
    """Return the unit normal from the second solid to the first, in the second one's axes.

    `offset`: vector from the centre of the second solid to that of the first, m. `axes`: rotation matrix from the axes of
    the first solid to those of the second, by rows. `first`, `second`: squared semi-axes of the ellipsoids whose
    Minkowski sum is the solid, m^2.
    """
    pose = [*offset, *axes, *_all_three(first), *_all_three(second)]
    return sp.Matrix([CommonNormal(sp.Integer(k), *pose) for k in range(3)])


def _all_three(ellipsoids: Sequence[Sequence[sp.Expr]]) -> list[sp.Expr]:
    squares = [square for ellipsoid in ellipsoids for square in ellipsoid]
    return squares + [sp.Integer(0)] * (9 - len(squares))


VALUE: Final = -1
"""Index of the argument to differentiate by, for the value itself."""


class PythonCall(sp.Function):  # type: ignore[misc]
    """Value of a Python function, or a derivative of it: PythonCall(address, count, output, by, arguments...).

    `stiffmbs.compile.callbacks.Callback` computes it; `by` is the argument to differentiate by, `VALUE` for none.
    """

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        address, count, output, by, *arguments = self.args
        if by != VALUE:
            raise InputError("found a second derivative of a Python function, expected it in efforts, and not in rates")
        return PythonCall(address, count, output, sp.Integer(argindex - 5), *arguments)


def python_law(address: sp.Symbol, read: Callable[[object], sp.Expr]) -> Callable[..., sp.Expr]:
    """Return the function called by equations: ``e.law(x, y)`` for one value, ``e.law(x, y, count=3)`` for a list."""

    def law(*arguments: object, count: int | None = None) -> Any:
        """Return the value of the function, or a list of `count` values."""
        if not arguments:
            raise InputError("found a Python function without arguments, expected one at least")
        given = [read(argument) for argument in arguments]
        values = [PythonCall(address, count or 1, k, VALUE, *given) for k in range(count or 1)]
        return values[0] if count is None else values

    return law
