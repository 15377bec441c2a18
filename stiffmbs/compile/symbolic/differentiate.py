"""Partial derivatives by the chain rule with shared subexpressions.

SymPy's `diff` traverses every subexpression for each derivative, which is slow for third derivatives of long equations
(a cam).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import sympy as sp

from .canonical import positive, product, total
from .nonsmooth import NonsmoothBase

Slope = tuple[sp.Symbol, sp.Expr]
"""Symbol that depends on a coordinate or velocity, and its derivative by that."""


class Derivatives:
    """Cached derivatives of the expressions of one element.

    `meanings`: expression of each named symbol, in order of definition.
    """

    def __init__(self) -> None:
        self._chain: dict[sp.Symbol, Mapping[sp.Symbol, sp.Expr]] = {}
        self._known: dict[tuple[sp.Expr, sp.Symbol], sp.Expr] = {}
        self._symbols: dict[sp.Expr, frozenset[sp.Symbol]] = {}
        self._variables: dict[sp.Symbol, frozenset[sp.Symbol]] = {}
        self._variables_of: dict[sp.Expr, frozenset[sp.Symbol]] = {}
        self._names: dict[sp.Expr, sp.Expr] = {}
        self._functions: dict[sp.Expr, sp.Symbol] = {}
        self.meanings: dict[sp.Symbol, sp.Expr] = {}

    def define(self, symbol: sp.Symbol, by: Mapping[sp.Symbol, sp.Expr], meaning: sp.Expr | None = None) -> None:
        """Define a symbol by its derivatives, and by its expression unless kernels know it."""
        self._chain[symbol] = by
        if meaning is not None:
            self.meanings[symbol] = meaning

    def defined(self) -> frozenset[sp.Symbol]:
        """Return the defined symbols, and those that they depend on."""
        changing = (symbol for by in self._chain.values() for symbol in by)
        return frozenset((*self._chain, *self.meanings, *changing))

    def named(self, x: sp.Expr) -> sp.Expr:
        """Return a symbol for an expression, with its derivatives; numbers and symbols are unchanged.

        A named expression is computed once, also in derivatives; an expression and its negative share one name.
        """
        if not x.args:
            return x
        if x not in self._names:
            opposite = positive(x)
            self._names[x] = self._new("named", x) if opposite is None else -self.named(opposite)
        return self._names[x]

    def variable(self, x: sp.Expr, state: Iterable[sp.Symbol]) -> sp.Symbol:
        """Return a symbol for an expression that depends on the state but not on other variables."""
        if isinstance(x, sp.Symbol) and x not in self.meanings:
            return x
        if x not in self._functions:
            symbol = self._functions[x] = self._new("variable", x)
            self._chain[symbol] = {v: self.partial(x, v) for v in state if v in self._variables[symbol]}
        return self._functions[x]

    def at_extremum(self, x: sp.Expr, at: Mapping[sp.Symbol, sp.Expr], state: Iterable[sp.Symbol]) -> sp.Expr:
        """Return a symbol for an expression at its extremum over some symbols; their derivatives vanish there."""
        symbol = self._new("extreme", x.xreplace(at))
        self._chain[symbol] = {
            v: self.named(self.partial(x, v).xreplace(at)) for v in state if v in self._variables[symbol]
        }
        return symbol

    def at_root(
        self,
        residual: Callable[[sp.Symbol], sp.Expr],
        value: sp.Expr,
        variables: Sequence[sp.Symbol],
        state: Iterable[sp.Symbol],
    ) -> sp.Symbol:
        """Return a symbol for the zero of a function of it and of few variables, with the given value.

        Its derivatives follow from the implicit function theorem.
        """
        symbol = self._new("root", value)
        self._chain[symbol] = {}  # a variable like the others until its derivatives are known
        function = residual(symbol)
        inverse = self.named(-1 / self.partial(function, symbol))
        slopes = [(self.named(inverse * self.partial(function, variable)), variable) for variable in variables]
        self._chain[symbol] = {
            v: total(product(slope, self.partial(variable, v)) for slope, variable in slopes)
            for v in state
            if v in self._variables[symbol]
        }
        return symbol

    def composed(self, x: sp.Expr, variables: Sequence[sp.Symbol], state: Iterable[sp.Symbol]) -> sp.Expr:
        """Return a symbol for an expression of few variables, differentiated through these variables."""
        if x not in self._functions:
            slopes = [(self.named(self.partial(x, variable)), variable) for variable in variables]
            symbol = self._functions[x] = self._new("composed", x)
            self._chain[symbol] = {
                v: total(product(slope, self.partial(variable, v)) for slope, variable in slopes)
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
        """Return the matrix d(column)/d(variables)."""
        rows, symbols = list(column), list(variables)
        return sp.Matrix(len(rows), len(symbols), lambda r, c: self.partial(rows[r], symbols[c]))

    def partial(self, x: sp.Expr, v: sp.Symbol) -> sp.Expr:
        """Return the derivative of x with respect to v."""
        if not x.args:
            return sp.Integer(1) if x == v else self._of_symbol(x, v)
        pair = x, v
        known = self._known.get(pair)
        if known is None:
            known = self._known[pair] = self._by_rule(x, v) if self._depends(x, v) else sp.Integer(0)
        return known

    def _of_symbol(self, x: sp.Symbol, v: sp.Symbol) -> sp.Expr:
        if x in self._chain:
            return self._chain[x].get(v, sp.Integer(0))
        if x not in self.meanings:
            return sp.Integer(0)
        if (x, v) not in self._known:
            self._known[x, v] = self.named(self.partial(self.meanings[x], v))
        return self._known[x, v]

    def along(self, x: sp.Expr, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
        """Return the rate of x for given symbol rates; rates of symbols are named to keep second rates short."""
        match x:
            case sp.Symbol() if x in rates:
                return rates[x]
            case sp.Symbol() if x in self._chain or x not in self.meanings:
                return self.named(self._by_all(x, rates))
            case sp.Symbol():
                return self.named(self.along(self.meanings[x], rates))
            case sp.Add():
                return total(self.along(part, rates) for part in x.args)
            case sp.Mul():
                return total(
                    product(*x.args[:k], self.along(part, rates), *x.args[k + 1 :]) for k, part in enumerate(x.args)
                )
            case _:
                return self._by_all(x, rates)

    def _by_all(self, x: sp.Expr, rates: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
        parts = ((rate, self.partial(x, symbol)) for symbol, rate in rates.items())
        return total(product(rate, part) for rate, part in parts if part is not sp.S.Zero)

    def _depends(self, x: sp.Expr, v: sp.Symbol) -> bool:
        """Return True if x depends on v."""
        return v in self.variables(x)

    def variables(self, x: sp.Expr) -> frozenset[sp.Symbol]:
        """Return the symbols of x, and those that they depend on, cached."""
        known = self._variables_of.get(x)
        if known is None:
            known = frozenset().union(*map(self._of_one, self.symbols_in(x)))
            self._variables_of[x] = known
        return known

    def _of_one(self, symbol: sp.Symbol) -> frozenset[sp.Symbol]:
        if symbol not in self._variables:
            self._variables[symbol] = frozenset((symbol, *self._chain.get(symbol, ())))
        return self._variables[symbol]

    def symbols_in(self, x: sp.Basic) -> frozenset[sp.Symbol]:
        """Return the symbols in an expression, cached."""
        known = self._symbols.get(x)
        if known is None:
            within = frozenset((x,)) if isinstance(x, sp.Symbol) else frozenset()
            known = self._symbols[x] = within.union(*map(self.symbols_in, x.args))
        return known

    def _by_rule(self, x: sp.Expr, v: sp.Symbol) -> sp.Expr:
        match x:
            case sp.Add():
                return total(self.partial(part, v) for part in x.args)
            case sp.Mul():
                return total(product(*x.args[:k], part, *x.args[k + 1 :]) for k, part in self._changed(x, v))
            case sp.Pow() if isinstance(x.base, sp.cosh) and x.exp.is_negative:
                (argument,) = x.base.args  # sinh(a)/cosh(a)^2 would overflow to NaN
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
                return total(product(x.fdiff(k + 1), part) for k, part in self._changed(x, v))
            case _:
                return sp.diff(x, v)

    def _changed(self, x: sp.Expr, v: sp.Symbol) -> Iterator[tuple[int, sp.Expr]]:
        """Yield the position and the derivative of each argument that depends on v."""
        for k, part in enumerate(x.args):
            if (changed := self.partial(part, v)) is not sp.S.Zero:
                yield k, changed
