"""Terms of a sum in the order in which SymPy prints them, found with less work.

SymPy compares monomials, then coefficients, which it evaluates as complex numbers: most of the time of printing a kernel.
Coefficients decide nothing where monomials differ, as they do in all sums that SymPy has put together itself.
"""

from __future__ import annotations

import sympy as sp
from sympy.core.exprtools import decompose_power
from sympy.core.sorting import default_sort_key

Monomial = dict[sp.Expr, sp.Integer | int]
"""Powers of what a term is a product of, but for numbers."""


def ordered_terms(x: sp.Add) -> list[sp.Expr] | None:
    """The terms of a sum by monomials, the highest first; None where these do not tell all terms apart, and for a number and
    one other, which SymPy may print first."""
    if len(x.args) == 2 and any(term.is_number for term in x.args):
        return None
    monomials = [(term, _monomial(term)) for term in x.args]
    bases = sorted({base for _, monomial in monomials for base in monomial}, key=default_sort_key)
    powers = {tuple(-monomial.get(base, 0) for base in bases): term for term, monomial in monomials}
    return [powers[power] for power in sorted(powers)] if len(powers) == len(x.args) else None


def _monomial(term: sp.Expr) -> Monomial:
    factors = sp.Mul.make_args(term)
    return dict(decompose_power(factor) for factor in factors if not factor.is_number)
