"""Partial derivatives by the chain rule, each subexpression once.

SymPy's own `diff` walks through every subexpression of every subexpression to prepare each derivative; for the third
derivatives of a long equation (a cam) that is most of the time of its first run, five times what this takes.
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp


class Derivatives:
    """Derivatives of the expressions of one element; what has been differentiated is remembered."""

    def __init__(self) -> None:
        self._known: dict[tuple[sp.Expr, sp.Symbol], sp.Expr] = {}

    def jacobian(self, column: Iterable[sp.Expr], variables: Iterable[sp.Symbol]) -> sp.Matrix:
        """The matrix d(column)/d(variables)."""
        rows, symbols = list(column), list(variables)
        return sp.Matrix(len(rows), len(symbols), lambda r, c: self.partial(rows[r], symbols[c]))

    def partial(self, x: sp.Expr, v: sp.Symbol) -> sp.Expr:
        """The derivative of x with respect to v."""
        if not x.args:
            return sp.Integer(int(x == v))
        if (x, v) not in self._known:
            self._known[x, v] = self._by_rule(x, v) if v in x.free_symbols else sp.Integer(0)
        return self._known[x, v]

    def _by_rule(self, x: sp.Expr, v: sp.Symbol) -> sp.Expr:
        match x:
            case sp.Add():
                return sp.Add(*(self.partial(part, v) for part in x.args))
            case sp.Mul():
                return sp.Add(*(self._with_one_factor_changed(x, k, v) for k in range(len(x.args))))
            case sp.Pow() if v not in x.exp.free_symbols:
                return x.exp * x.base ** (x.exp - 1) * self.partial(x.base, v)
            case sp.Piecewise():
                return sp.Piecewise(*((self.partial(part, v), condition) for part, condition in x.args))
            case sp.Function():
                return sp.Add(*(self._through_argument(x, k, v) for k in range(len(x.args))))
            case _:
                return sp.diff(x, v)

    def _with_one_factor_changed(self, x: sp.Mul, k: int, v: sp.Symbol) -> sp.Expr:
        changed = self.partial(x.args[k], v)
        return changed if changed is sp.S.Zero else sp.Mul(*x.args[:k], changed, *x.args[k + 1 :])

    def _through_argument(self, x: sp.Function, k: int, v: sp.Symbol) -> sp.Expr:
        changed = self.partial(x.args[k], v)
        return changed if changed is sp.S.Zero else x.fdiff(k + 1) * changed
