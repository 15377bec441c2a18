"""Dimensional analysis of formulas.

Time, coordinates and measures have a dimension. A plain number can have any: in ``-100*cart.x`` it is a stiffness. In
products with units it is dimensionless, as in fields: ``2*3 kg`` is a mass, and so is ``2*k`` if the parameter k is
one.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass

from ..units.units import DIMENSIONS, NUMBER, Dimension, Quantity, named_unit
from .text import FormulaError, as_written

SAME_EXPONENT = 1e-9
"""Tolerance of exponents, as 1/3 + 2/3 must equal 1."""


@dataclass(frozen=True)
class Known:
    """Known dimension of a part of a formula.

    `exponents`: exponents of kg, m and s, with plain numbers as dimensionless; None if unknown. `stated`: true if the
    part contains a unit. `plain`: true if it contains a plain number.
    """

    exponents: Dimension | None
    stated: bool = False
    plain: bool = False

    @property
    def fits_all(self) -> bool:
        """True if the part can have any dimension, because it is unknown or contains a plain number and no unit."""
        return self.exponents is None or (self.plain and not self.stated)

    def agrees_with(self, other: Known) -> bool:
        """Return False if the part contains a unit and contradicts the known dimension of another part."""
        if not self.stated or self.exponents is None or other.exponents is None:
            return True
        return other.fits_all or same(self.exponents, other.exponents)

    def is_of(self, dimension: str) -> bool:
        """Return False if the part contains a unit and contradicts a dimension of `DIMENSIONS`."""
        return self.agrees_with(measured_in(dimension))


UNKNOWN = Known(None)
PLAIN = Known(NUMBER, plain=True)
Part = tuple[Known, ast.expr]
"""Dimension of a part of a formula, and its tree, for messages."""


def same(a: Dimension, b: Dimension) -> bool:
    """Return True if two dimensions are equal."""
    return all(abs(x - y) <= SAME_EXPONENT for x, y in zip(a, b, strict=True))


def measured_in(dimension: str) -> Known:
    """Return the dimension of time, a coordinate or a measure."""
    return Known(DIMENSIONS[dimension][0])


def known_of(quantity: Quantity) -> Known:
    """Return the dimension of a number, a parameter or a unit."""
    return PLAIN if quantity.dimension is None else Known(quantity.dimension, stated=True)


def product(a: Known, b: Known, sign: int = 1) -> Known:
    """Return the dimension of a product, or with sign -1 of a quotient."""
    if a.exponents is None or b.exponents is None:
        return UNKNOWN
    exponents = tuple(x + sign * y for x, y in zip(a.exponents, b.exponents, strict=True))
    return Known(exponents, a.stated or b.stated, a.plain or b.plain)


def power(base: Known, exponent: Part, value: float | None) -> Known:
    """Return the dimension of a power; `value` is the constant exponent, or None.

    Raise a FormulaError if the exponent has a unit, or is variable and the base has one.
    """
    plain_number(exponent)
    if base.exponents is None or same(base.exponents, NUMBER):
        return base
    if value is None:
        if base.stated:
            raise FormulaError(
                f"found the exponent '{as_written(exponent[1])}' of a quantity with a unit, expected a number"
            )
        return UNKNOWN
    return Known(tuple(x * value for x in base.exponents), base.stated, base.plain)


def alike(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return the common dimension of parts such as the terms of a sum.

    If they differ, raise a FormulaError that quotes `where`.
    """
    (found, _), *others = parts
    for other, _ in others:
        found = _joined(found, other, where)
    return found


def _joined(a: Known, b: Known, where: ast.expr) -> Known:
    if a.exponents is None or b.exponents is None:
        known = b if a.exponents is None else a
        return UNKNOWN if known.fits_all else known
    if a.fits_all != b.fits_all:
        return b if a.fits_all else a
    if not same(a.exponents, b.exponents):
        if a.fits_all:
            return UNKNOWN
        raise FormulaError(
            f"found {named_unit(a.exponents)} and {named_unit(b.exponents)} in '{as_written(where)}', expected one unit in both"
        )
    return Known(a.exponents, a.stated or b.stated, a.plain and b.plain)


def plain_number(part: Part) -> Known:
    """Return the dimension of a function such as ``sin``; raise a FormulaError if its argument has a unit other than an angle's.

    Time and coordinates in SI units are accepted as arguments.
    """
    known, node = part
    if known.stated and known.exponents is not None and not same(known.exponents, NUMBER):
        raise FormulaError(
            f"found {named_unit(known.exponents)} in '{as_written(node)}', expected a plain number or an angle"
        )
    return PLAIN


def of_numbers(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return a plain number, for arguments that are plain numbers or angles."""
    for part in parts:
        plain_number(part)
    return PLAIN


def of_first(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return the dimension of the first argument."""
    return parts[0][0]


def of_root(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return the square root of the argument's dimension."""
    return power(parts[0][0], (PLAIN, where), 0.5)


def of_angle(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return an angle, for arguments of equal dimension."""
    found = alike(parts, where)
    return Known(PLAIN.exponents, found.stated, found.fits_all)


def plain_always(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return a plain number, for any arguments."""
    return PLAIN


def of_step(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return the dimension of STEP(x, x0, h0, x1, h1); x0 and x1 must agree with x, and h0 with h1."""
    x, x0, h0, x1, h1 = parts
    alike((x, x0, x1), where)
    return alike((h0, h1), where)


def of_branch(parts: Sequence[Part], where: ast.expr) -> Known:
    """Return the common dimension of the three alternatives."""
    return alike(parts[1:], where)
