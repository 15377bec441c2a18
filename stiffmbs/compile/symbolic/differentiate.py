"""Partial derivatives by the chain rule, each subexpression once.

SymPy's own `diff` walks through every subexpression of every subexpression to prepare each derivative; for the third
derivatives of a long equation (a cam) that is most of the time of its first run, five times what this takes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import sympy as sp

from .nonsmooth import NonsmoothBase

Way = tuple[sp.Symbol, sp.Expr]
"""A symbol that changes with a coordinate or velocity, and its derivative by that."""


class Derivatives:
    """Derivatives of the expressions of one element; what has been differentiated is remembered.

    Attributes
    ----------
    meanings : dict
        What each name stands for; names in it have been given before.
    """

    def __init__(self) -> None:
        self._chain: dict[sp.Symbol, Mapping[sp.Symbol, sp.Expr]] = {}
        self._known: dict[tuple[sp.Expr, sp.Symbol], sp.Expr] = {}
        self._symbols: dict[sp.Expr, frozenset[sp.Symbol]] = {}
        self._variables: dict[sp.Symbol, frozenset[sp.Symbol]] = {}
        self._names: dict[sp.Expr, sp.Symbol] = {}
        self._functions: dict[sp.Expr, sp.Symbol] = {}
        self.meanings: dict[sp.Symbol, sp.Expr] = {}

    def define(self, symbol: sp.Symbol, by: Mapping[sp.Symbol, sp.Expr], meaning: sp.Expr | None = None) -> None:
        """Make a symbol a function of others by its derivatives; what it stands for is said unless kernels know it."""
        self._chain[symbol] = by
        if meaning is not None:
            self.meanings[symbol] = meaning

    def defined(self) -> frozenset[sp.Symbol]:
        """The symbols that stand for something, and those that they change with."""
        changing = (symbol for by in self._chain.values() for symbol in by)
        return frozenset((*self._chain, *self.meanings, *changing))

    def named(self, x: sp.Expr) -> sp.Expr:
        """A symbol that stands for an expression, and is differentiated as that; numbers and symbols stay as they are.

        What is named is written once wherever it occurs, in derivatives too; an expression and its opposite have one name.
        """
        if not x.args:
            return x
        if x.could_extract_minus_sign():
            return -self.named(-x)
        if x not in self._names:
            self._names[x] = self._new("named", x)
        return self._names[x]

    def variable(self, x: sp.Expr, state: Iterable[sp.Symbol]) -> sp.Symbol:
        """A symbol that stands for an expression and changes with the state alone: not with other variables in its meaning."""
        if isinstance(x, sp.Symbol) and x not in self.meanings:
            return x
        if x not in self._functions:
            symbol = self._functions[x] = self._new("variable", x)
            self._chain[symbol] = {v: self.partial(x, v) for v in state if v in self._variables[symbol]}
        return self._functions[x]

    def at_extremum(self, x: sp.Expr, at: Mapping[sp.Symbol, sp.Expr], state: Iterable[sp.Symbol]) -> sp.Expr:
        """A symbol for an expression at those values of some symbols where it is largest or least: it does not change with them."""
        symbol = self._new("extreme", x.xreplace(at))
        self._chain[symbol] = {
            v: self.named(self.partial(x, v).xreplace(at)) for v in state if v in self._variables[symbol]
        }
        return symbol

    def composed(self, x: sp.Expr, variables: Sequence[sp.Symbol], state: Iterable[sp.Symbol]) -> sp.Expr:
        """A symbol for an expression of a few variables: its derivatives by the state go through those by the variables."""
        if x not in self._functions:
            slopes = [(self.named(self.partial(x, variable)), variable) for variable in variables]
            symbol = self._functions[x] = self._new("composed", x)
            self._chain[symbol] = {
                v: sp.Add(*(slope * self.partial(variable, v) for slope, variable in slopes))
                for v in state
                if v in self._variables[symbol]
            }
        return self._functions[x]

    def _new(self, stem: str, x: sp.Expr) -> sp.Symbol:
        symbol = sp.Symbol(f"{stem}{len(self.meanings)}", real=True)
        self.meanings[symbol] = x
        self._variables[symbol] = self.variables(x) | {symbol}
        return symbol

    def jacobian(self, column: Iterable[sp.Expr], variables: Iterable[sp.Symbol]) -> sp.Matrix:
        """The matrix d(column)/d(variables)."""
        rows, symbols = list(column), list(variables)
        return sp.Matrix(len(rows), len(symbols), lambda r, c: self.partial(rows[r], symbols[c]))

    def partial(self, x: sp.Expr, v: sp.Symbol) -> sp.Expr:
        """The derivative of x with respect to v."""
        if not x.args:
            return sp.Integer(1) if x == v else self._of_symbol(x, v)
        if (x, v) not in self._known:
            self._known[x, v] = self._by_rule(x, v) if self._depends(x, v) else sp.Integer(0)
        return self._known[x, v]

    def _of_symbol(self, x: sp.Symbol, v: sp.Symbol) -> sp.Expr:
        if x in self._chain:
            return self._chain[x].get(v, sp.Integer(0))
        if x not in self.meanings:
            return sp.Integer(0)
        if (x, v) not in self._known:
            self._known[x, v] = self.named(self.partial(self.meanings[x], v))
        return self._known[x, v]

    def along(self, x: sp.Expr, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
        """The rate of x where some symbols have rates: each symbol's own by a name, so that the rate of a rate has few products."""
        match x:
            case sp.Symbol():
                return rates[x] if x in rates else self._rate_of_symbol(x, rates)
            case sp.Add():
                return sp.Add(*(self.along(part, rates) for part in x.args))
            case sp.Mul():
                return sp.Add(
                    *(sp.Mul(*x.args[:k], self.along(part, rates), *x.args[k + 1 :]) for k, part in enumerate(x.args))
                )
            case _:
                return self._by_all(x, rates)

    def _rate_of_symbol(self, x: sp.Symbol, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
        if x in self._chain or x not in self.meanings:
            return self.named(self._by_all(x, rates))
        return self.named(self.along(self.meanings[x], rates))

    def _by_all(self, x: sp.Expr, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
        return sp.Add(*(rate * self.partial(x, symbol) for symbol, rate in rates.items()))

    def _depends(self, x: sp.Expr, v: sp.Symbol) -> bool:
        """Whether v, or a symbol that stands for a function of v, occurs in x."""
        return any(v in self._of_one(symbol) for symbol in self.symbols_in(x))

    def variables(self, x: sp.Expr) -> frozenset[sp.Symbol]:
        """The symbols of x, and those that they are functions of."""
        return frozenset().union(*(self._of_one(symbol) for symbol in self.symbols_in(x)))

    def _of_one(self, symbol: sp.Symbol) -> frozenset[sp.Symbol]:
        if symbol not in self._variables:
            self._variables[symbol] = frozenset((symbol, *self._chain.get(symbol, ())))
        return self._variables[symbol]

    def symbols_in(self, x: sp.Basic) -> frozenset[sp.Symbol]:
        """The symbols in an expression; SymPy itself would walk through all of it each time."""
        if x not in self._symbols:
            within = frozenset((x,)) if isinstance(x, sp.Symbol) else frozenset()
            self._symbols[x] = within.union(*map(self.symbols_in, x.args))
        return self._symbols[x]

    def _by_rule(self, x: sp.Expr, v: sp.Symbol) -> sp.Expr:
        match x:
            case sp.Add():
                return sp.Add(*(self.partial(part, v) for part in x.args))
            case sp.Mul():
                return sp.Add(*(self._with_one_factor_changed(x, k, v) for k in range(len(x.args))))
            case sp.Pow() if isinstance(x.base, sp.cosh) and x.exp.is_negative:
                (argument,) = x.base.args  # sinh(a)/cosh(a)^2 is no number where both have left the range of numbers
                return x.exp * x * sp.tanh(argument) * self.partial(argument, v)
            case sp.Pow() if not self._depends(x.exp, v):
                return x.exp * x.base ** (x.exp - 1) * self.partial(x.base, v)
            case sp.Pow():
                base, exponent = x.args
                changed = self.partial(exponent, v) * sp.log(base) + exponent * self.partial(base, v) / base
                return x * changed
            case sp.Piecewise():
                return sp.Piecewise(*((self.partial(part, v), condition) for part, condition in x.args))
            case NonsmoothBase():
                return x.by_parts(lambda part: self.partial(part, v))
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
