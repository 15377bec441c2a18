"""Dependence of constraint derivatives on numbers and coordinates, from their symbols.

A derivative is split into summands, each a product of an element's numbers with a function of the pose. A summand with
zero numbers is zero at every pose, such as the arm of a pin in the centre of mass. A function of the pose is never
assumed zero from its values: tanh and exp are exactly constant in floating point where they are saturated.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp

from .symbols import Symbols

MOST_SUMMANDS = 100
"""Limit of the number of summands; a longer derivative is not split."""
ORDER_ONE = 8
"""Magnitude of a number up to which it counts as of order one."""

Factors = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Summand:
    """Part of a derivative.

    `factors`: factors that are numbers of the element: each a number, or the numbers of a vector in any combination.
    `columns`: coordinates of the element on which the rest depends. `bounded`: true if the rest is of order one at
    every pose, as sines and cosines are.
    """

    factors: Factors
    columns: tuple[int, ...]
    bounded: bool


_Sum = dict[Factors, tuple[frozenset[int], bool]]
"""Summands by their factors."""


class Variation:
    """Splitting of derivatives of one kind. `symbols`: symbols of the derivatives."""

    def __init__(self, symbols: Symbols) -> None:
        self._e = symbols.element
        self._number: dict[sp.Basic, int] = {symbol: k for k, symbol in enumerate(symbols.numbers)}
        self._vector = {part: own for frame in self._e.frames for part, own in frame.vectors.items()}
        self._bounded = {symbol for frame in self._e.frames for symbol in frame.bounded}
        self._nonsmooth = bool(symbols.event_functions)
        self._known: dict[sp.Expr, _Sum] = {}

    def summands(self, x: sp.Expr) -> list[Summand]:
        """Return the summands of an expression; empty if it is zero."""
        return [
            Summand(factors, tuple(sorted(columns)), bounded) for factors, (columns, bounded) in self._sum(x).items()
        ]

    def removable(self, C: sp.Expr, differentiated: Iterable[int]) -> bool:
        """Return True if an equation follows from its derivatives at every pose: no time, breakpoints or jumps.

        It then depends only on coordinates by which it has derivatives.
        """
        timeless = not self._e.depends(C, [self._e.t])
        return timeless and not self._nonsmooth and set(self._e.by_q.of(C)) <= set(differentiated)

    def _sum(self, x: sp.Expr) -> _Sum:
        if x not in self._known:
            found = self._apart(x)
            self._known[x] = found if len(found) <= MOST_SUMMANDS else self._whole(x)
        return self._known[x]

    def _apart(self, x: sp.Expr) -> _Sum:
        match x:
            case sp.Add():
                return _added(self._sum(part) for part in x.args)
            case sp.Mul():
                return self._multiplied(x, x.args)
            case sp.Pow(base=base, exp=sp.Integer() as n) if 1 < n <= 4:
                return self._multiplied(x, [base] * int(n))
            case sp.Symbol() if x in self._number:
                return {((self._number[x],),): (frozenset(), True)}
            case sp.Symbol() if x in self._vector and all(own in self._number for own in self._vector[x]):
                own = tuple(self._number[number] for number in self._vector[x])
                return {(own,): (frozenset(self._e.by_q.of(x)), True)}
            case sp.Symbol() if x in self._e.meanings:
                return self._sum(self._e.meanings[x])
        return {} if x == 0 else self._whole(x)

    def _whole(self, x: sp.Expr) -> _Sum:
        bounded = x in self._bounded or isinstance(x, sp.sin | sp.cos) or (x.is_number and abs(x) <= ORDER_ONE)
        return {(): (frozenset(self._e.by_q.of(x)), bool(bounded))}

    def _multiplied(self, x: sp.Expr, parts: Iterable[sp.Expr]) -> _Sum:
        product: _Sum = {(): (frozenset(), True)}
        for part in parts:
            by = self._sum(part)
            if len(product) * len(by) > MOST_SUMMANDS:
                return self._whole(x)
            product = _added(
                {tuple(sorted((*f, *g))): (columns | others, bounded and also)}
                for f, (columns, bounded) in product.items()
                for g, (others, also) in by.items()
            )
        return product


def _added(sums: Iterable[_Sum]) -> _Sum:
    total: _Sum = {}
    for found in sums:
        for factors, (columns, bounded) in found.items():
            others, also = total.get(factors, (frozenset(), True))
            total[factors] = columns | others, bounded and also
    return total
