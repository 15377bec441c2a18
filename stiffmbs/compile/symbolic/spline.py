"""Tables in equations."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp


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
