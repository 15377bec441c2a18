"""SymPy's sums and products, made faster where no terms combine and no factors have a common base."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp
from sympy.core.basic import _args_sortkey


def total(parts: Iterable[sp.Expr]) -> sp.Expr:
    """Return ``sympy.Add(*parts)``."""
    parts = [part for part in parts if part is not sp.S.Zero]
    if len(parts) < 2:
        return parts[0] if parts else sp.S.Zero
    flat = [term for part in parts for term in (part.args if part.is_Add else (part,))]
    numbers, ordered = _apart(flat)
    terms = {term.as_coeff_Mul()[1] if term.is_Mul else term for term in ordered}
    of_numbers = any(term.is_Pow and term.base.is_Number for term in ordered)
    if of_numbers or len(terms) < len(ordered) or len(numbers) > 1 or not all(number.is_finite for number in numbers):
        return sp.Add(*parts)
    return sp.Add._from_args([*numbers, *ordered], True)


def product(*factors: sp.Expr) -> sp.Expr:
    """Return ``sympy.Mul(*factors)``; zero for a factor 0, without SymPy's search for infinite factors among functions."""
    given = [factor for factor in factors if factor.is_Number]
    if any(number is sp.S.Zero for number in given) and all(number.is_finite for number in given):
        return sp.S.Zero
    flat = [part for factor in factors for part in (factor.args if factor.is_Mul else (factor,))]
    numbers, ordered = _apart([part for part in flat if part is not sp.S.One])
    bases = {part.base if part.is_Pow and part.exp.is_Rational else part for part in ordered}
    number = numbers[0] * numbers[1] if len(numbers) == 2 else numbers[0] if numbers else sp.S.One
    distributes = number is not sp.S.One and len(ordered) == 1 and ordered[0].is_Add
    is_usual = len(bases) == len(ordered) > 0 and len(numbers) < 3 and all(map(_is_plain, bases))
    if distributes or not is_usual or number.is_zero or not number.is_finite:
        return sp.Mul(*factors)
    every = ordered if number is sp.S.One else [number, *ordered]
    return sp.Mul._from_args(every, True) if len(every) > 1 else every[0]


def positive(x: sp.Expr) -> sp.Expr | None:
    """Return ``-x`` if ``x.could_extract_minus_sign()``; otherwise None."""
    if not x.is_Add:
        return -x if _has_minus(x) else None
    n_positive = len(x.args) - 2 * sum(map(_has_minus, x.args))
    if n_positive > 0:
        return None
    if any(part.is_number or any(map(_is_irrational, sp.Mul.make_args(part))) for part in x.args):
        return -x if x.could_extract_minus_sign() else None
    is_negative = n_positive < 0 or _has_minus(x.as_ordered_terms()[0])  # keys of x and -x differ there first
    return total(-part for part in x.args) if is_negative else None


def _is_irrational(factor: sp.Expr) -> bool:
    return bool(factor.is_number and not factor.is_Number)


def _has_minus(x: sp.Expr) -> bool:
    factor = x.args[0] if x.is_Mul else x
    return bool(factor.is_extended_negative if factor.is_Number else not x.is_Mul and x.could_extract_minus_sign())


def _apart(parts: list[sp.Expr]) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """Return the numbers, and all others in SymPy's order."""
    others = [part for part in parts if not part.is_Number]
    others.sort(key=_args_sortkey)
    return [part for part in parts if part.is_Number], others


def _is_plain(base: sp.Expr) -> bool:
    """Return True for bases that SymPy combines with equal ones only."""
    return base.is_Symbol or base.is_Add or (isinstance(base, sp.Function) and not isinstance(base, sp.exp))
