"""Fast ordering of the terms of a sum, as printed by SymPy.

SymPy compares monomials, then coefficients as complex numbers, which is slow. Coefficients do not matter where
monomials differ, as in all sums simplified by SymPy.
"""

from __future__ import annotations

import sympy as sp
from sympy.core.exprtools import decompose_power
from sympy.core.sorting import default_sort_key

Monomial = dict[sp.Expr, sp.Integer | int]
"""Powers of the non-numeric factors of a term."""


def ordered_terms(x: sp.Add) -> list[sp.Expr] | None:
    """Return the terms of a sum by monomials, highest first; None if these do not distinguish all terms, or for a
    number plus one other term."""
    if len(x.args) == 2 and any(term.is_number for term in x.args):
        return None
    monomials = [(term, _monomial(term)) for term in x.args]
    bases = sorted({base for _, monomial in monomials for base in monomial}, key=default_sort_key)
    powers = {tuple(-monomial.get(base, 0) for base in bases): term for term, monomial in monomials}
    return [powers[power] for power in sorted(powers)] if len(powers) == len(x.args) else None


def _monomial(term: sp.Expr) -> Monomial:
    factors = sp.Mul.make_args(term)
    return dict(decompose_power(factor) for factor in factors if not factor.is_number)
