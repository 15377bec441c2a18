"""The dimension of a part of a formula, as far as it is known, and the rules of arithmetic for it.

Time, coordinates and measures have a dimension.  A plain number may have any: in ``-100*cart.x`` it is a stiffness.  Beside
a unit it has none, as in fields: ``2*3 kg`` is a mass, and so is ``2*k`` if the scene's k is one.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass

from ..units.units import DIMENSIONS, NUMBER, Dimension, Quantity, named_unit
from .text import FormulaError, as_written

SAME_EXPONENT = 1e-9
"""What exponents may differ by: 1/3 + 2/3 is 1."""


@dataclass(frozen=True)
class Known:
    """What is known of a part's dimension.

    Attributes
    ----------
    exponents : tuple of float, or None
        Of kg, m and s, plain numbers being taken as pure numbers; None where they tell nothing.
    stated : bool
        Whether a unit stands in the part.
    plain : bool
        Whether a plain number stands in it.
    """

    exponents: Dimension | None
    stated: bool = False
    plain: bool = False

    @property
    def fits_all(self) -> bool:
        """Whether the part may have any dimension, as a plain number in it has one that nobody wrote."""
        return self.exponents is None or (self.plain and not self.stated)

    def agrees_with(self, other: Known) -> bool:
        """Whether the part, if a unit stands in it, has another part's dimension, as far as that is known."""
        if not self.stated or self.exponents is None or other.exponents is None:
            return True
        return other.fits_all or same(self.exponents, other.exponents)

    def is_of(self, dimension: str) -> bool:
        """The same for a dimension of `DIMENSIONS`."""
        return self.agrees_with(measured_in(dimension))


UNKNOWN = Known(None)
PLAIN = Known(NUMBER, plain=True)
Part = tuple[Known, ast.expr]
"""What is known of a part of a formula, and the part, for messages."""


def same(a: Dimension, b: Dimension) -> bool:
    """Whether two dimensions are one."""
    return all(abs(x - y) <= SAME_EXPONENT for x, y in zip(a, b, strict=True))


def measured_in(dimension: str) -> Known:
    """Of time, a coordinate or a measure."""
    return Known(DIMENSIONS[dimension][0])


def known_of(quantity: Quantity) -> Known:
    """Of a number, a parameter or a unit."""
    return PLAIN if quantity.dimension is None else Known(quantity.dimension, stated=True)


def product(a: Known, b: Known, sign: int = 1) -> Known:
    """Of a product, or with sign -1 of a quotient."""
    if a.exponents is None or b.exponents is None:
        return UNKNOWN
    (kg, m, s), (x, y, z) = a.exponents, b.exponents
    return Known((kg + sign * x, m + sign * y, s + sign * z), a.stated or b.stated, a.plain or b.plain)


def power(base: Known, exponent: Part, value: float | None) -> Known:
    """Of a power; `value` is the exponent's where that is a number.

    Raises
    ------
    FormulaError
        When the exponent has a unit, or changes and the base has one.
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
    kg, m, s = (x * value for x in base.exponents)
    return Known((kg, m, s), base.stated, base.plain)


def alike(parts: Sequence[Part], where: ast.expr) -> Known:
    """Of parts that must have one dimension, such as the terms of a sum.

    Raises
    ------
    FormulaError
        When they have not; `where` is what they stand in.
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
    """Of the result of a function such as ``sin``, whose argument is a plain number or an angle; t and coordinates in SI
    units will do.

    Raises
    ------
    FormulaError
        When the argument has a unit.
    """
    known, node = part
    if known.stated and known.exponents is not None and not same(known.exponents, NUMBER):
        raise FormulaError(
            f"found {named_unit(known.exponents)} in '{as_written(node)}', expected a plain number or an angle"
        )
    return PLAIN


def of_numbers(parts: Sequence[Part], where: ast.expr) -> Known:
    """A plain number from plain numbers or angles."""
    for part in parts:
        plain_number(part)
    return PLAIN


def of_first(parts: Sequence[Part], where: ast.expr) -> Known:
    """The dimension of the argument."""
    return parts[0][0]


def of_root(parts: Sequence[Part], where: ast.expr) -> Known:
    """The square root of the argument's."""
    return power(parts[0][0], (PLAIN, where), 0.5)


def of_angle(parts: Sequence[Part], where: ast.expr) -> Known:
    """An angle from lengths, or from anything alike."""
    found = alike(parts, where)
    return Known(PLAIN.exponents, found.stated, found.fits_all)


def plain_always(parts: Sequence[Part], where: ast.expr) -> Known:
    """A plain number from anything."""
    return PLAIN


def of_step(parts: Sequence[Part], where: ast.expr) -> Known:
    """STEP(x, x0, h0, x1, h1): x0 and x1 are like x; h0 like h1."""
    x, x0, h0, x1, h1 = parts
    alike((x, x0, x1), where)
    return alike((h0, h1), where)


def of_branch(parts: Sequence[Part], where: ast.expr) -> Known:
    """That of the three values that one is chosen of."""
    return alike(parts[1:], where)
