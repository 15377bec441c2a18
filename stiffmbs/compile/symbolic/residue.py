"""Value of a rational function modulo a prime, whose digits stay few for any powers."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import prod
from typing import Final

import sympy as sp

PRIME: Final = 2**127 - 1
"""A Mersenne prime: a function of degree d that is not zero has the residue 0 with a probability of d/PRIME (Schwartz 1980)."""


def residue(x: sp.Basic, values: Mapping[sp.Basic, int]) -> int | None:
    """Return the residue of an expression at given values of its symbols; None if it is not a rational function.

    In contrast to exact integers, towers of powers such as ((t^1000 + 1)^1000 + 1)^1000 are evaluated at once.
    """
    if x in values:
        return values[x] % PRIME
    if isinstance(x, sp.Rational | sp.Float):
        exact = Fraction(x.p, x.q) if isinstance(x, sp.Rational) else Fraction(float(x))
        return _quotient(exact.numerator, exact.denominator)
    if isinstance(x, sp.Pow) and isinstance(x.exp, sp.Integer):
        base, exponent = residue(x.base, values), int(x.exp)
        return None if base is None or (base == 0 and exponent < 0) else pow(base, exponent, PRIME)
    if not isinstance(x, sp.Add | sp.Mul):
        return None
    parts = []
    for part in x.args:
        found = residue(part, values)
        if found is None:
            return None
        parts.append(found)
    return (sum(parts) if isinstance(x, sp.Add) else prod(parts)) % PRIME


def _quotient(numerator: int, denominator: int) -> int | None:
    return numerator * pow(denominator, -1, PRIME) % PRIME if denominator % PRIME else None
