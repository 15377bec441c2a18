"""Nonsmooth functions in equations: derivatives, and native functions in kernels.

Each argument occurs once. SymPy's Piecewise repeats arguments in every condition and value, so nested steps grow
exponentially.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import ClassVar

import sympy as sp

Partial = Callable[[sp.Expr], sp.Expr]
"""Function that returns the derivative of an expression by some symbol."""


class NonsmoothBase(sp.Function):  # type: ignore[misc]
    """Base of nonsmooth functions. SymPy's printers find its method by this name.

    `native`: function in `stiffmbs.compile.machine.native.nonsmooth`.
    """

    native: ClassVar[str] = ""
    is_real = True

    def by_parts(self, partial: Partial) -> sp.Expr:
        """Return the derivative from those of the arguments, of which only the selected one counts."""
        raise NotImplementedError

    def _eval_derivative(self, symbol: sp.Symbol) -> sp.Expr:
        return self.by_parts(lambda part: sp.diff(part, symbol))


class Chosen(NonsmoothBase):
    """One of three expressions by the sign of the first: Chosen(x, below, at, above)."""

    native = "chosen"

    @classmethod
    def eval(cls, x: sp.Expr, below: sp.Expr, at: sp.Expr, above: sp.Expr) -> sp.Expr | None:
        if below == at == above:
            return at
        return (below if x < 0 else above if x > 0 else at) if x.is_Number else None

    def by_parts(self, partial: Partial) -> sp.Expr:
        x, *values = self.args
        return Chosen(x, *map(partial, values))


class Sign(NonsmoothBase):
    """Sign of x, -1 or 1, with zero derivative."""

    native = "sign"

    @classmethod
    def eval(cls, x: sp.Expr) -> sp.Expr | None:
        return sp.Integer(1 if x >= 0 else -1) if x.is_Number else None

    def by_parts(self, partial: Partial) -> sp.Expr:
        return sp.Integer(0)


class Magnitude(NonsmoothBase):
    """Absolute value."""

    native = "magnitude"

    @classmethod
    def eval(cls, x: sp.Expr) -> sp.Expr | None:
        return abs(x) if x.is_Number else None

    def by_parts(self, partial: Partial) -> sp.Expr:
        (x,) = self.args
        return Sign(x) * partial(x)


class Extreme(NonsmoothBase):
    """Extremum of two expressions, the first if equal, with its derivative; `of_numbers` is SymPy's equivalent."""

    of_numbers: ClassVar[Callable[..., sp.Expr]]

    @classmethod
    def eval(cls, a: sp.Expr, b: sp.Expr) -> sp.Expr | None:
        return a if a == b else cls.of_numbers(a, b) if a.is_Number and b.is_Number else None

    def by_parts(self, partial: Partial) -> sp.Expr:
        a, b = self.args
        return Chosen(a - b if self.of_numbers is sp.Max else b - a, partial(b), partial(a), partial(a))


class Greater(Extreme):
    """Greater of two expressions."""

    native = "greater"
    of_numbers = sp.Max


class Less(Extreme):
    """Smaller of two expressions."""

    native = "less"
    of_numbers = sp.Min


class Inside(NonsmoothBase):
    """Value for x between two bounds, zero elsewhere: Inside(x, x0, x1, value)."""

    native = "inside"

    @classmethod
    def eval(cls, x: sp.Expr, x0: sp.Expr, x1: sp.Expr, value: sp.Expr) -> sp.Expr | None:
        return value if value.is_zero else None

    def by_parts(self, partial: Partial) -> sp.Expr:
        *bounds, value = self.args
        return Inside(*bounds, partial(value))


class Step(NonsmoothBase):
    """Adams' STEP, or a derivative of it by x: Step(x, x0, h0, x1, h1, order), a cubic with zero end slopes."""

    native = "step"

    def by_parts(self, partial: Partial) -> sp.Expr:
        """Differentiate (h1 - h0) p^(k)(z)/(x1 - x0)^k with z = (x - x0)/(x1 - x0), linear in h0 and h1."""
        x, x0, h0, x1, h1, order = self.args
        low, high, shift, shift0, shift1 = map(partial, (h0, h1, x, x0, x1))
        width = x1 - x0
        moved = shift + (shift0 * (x - x1) - shift1 * (x - x0)) / width
        inner = self.func(x, x0, h0, x1, h1, order + 1) * moved - order * self * (shift1 - shift0) / width
        levels = 0 if low == high == 0 else self.func(x, x0, low, x1, high, order)
        return levels + Inside(x, x0, x1, inner)


class Step5(Step):
    """Adams' STEP5: a quintic with zero end slopes and curvatures."""

    native = "step5"


def step(x: sp.Expr, x0: sp.Expr, h0: sp.Expr, x1: sp.Expr, h1: sp.Expr) -> sp.Expr:
    """Return Adams' STEP: a cubic from h0 at x0 to h1 at x1 with zero end slopes."""
    return Step(x, x0, h0, x1, h1, 0)


def step5(x: sp.Expr, x0: sp.Expr, h0: sp.Expr, x1: sp.Expr, h1: sp.Expr) -> sp.Expr:
    """Return Adams' STEP5: a quintic from h0 at x0 to h1 at x1 with zero end slopes and curvatures."""
    return Step5(x, x0, h0, x1, h1, 0)


def greater(first: sp.Expr, *others: sp.Expr) -> sp.Expr:
    """Return the greatest argument, with its derivative."""
    return reduce(Greater, others, first)


def less(first: sp.Expr, *others: sp.Expr) -> sp.Expr:
    """Return the smallest argument, with its derivative."""
    return reduce(Less, others, first)
