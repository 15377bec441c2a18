"""Numbers of any dimension that remember the unit which they were written with."""

from __future__ import annotations

from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..files.quoted import quoted
from ..formula.dimension import PLAIN, UNKNOWN, Known, known_of
from ..formula.text import FormulaError
from ..units.quantity import in_si, quantity
from ..units.units import ANY, Quantity


class Amount(float):
    """A finite number in SI units, and what is known of its dimension.

    Attributes
    ----------
    known : Known
        A number without a unit may have any dimension.
    """

    known: Known = PLAIN

    @classmethod
    def read(cls, found: Any, info: ValidationInfo) -> Amount:
        """The number that stands in the scene, or is given in Python."""
        if isinstance(found, Amount):
            return found
        parameters = (info.context or {}).get("parameters")
        amount = cls(in_si(found, ANY, parameters))
        if isinstance(found, str):
            amount.known = known_of(quantity(found, parameters))
        return amount

    @property
    def dimension(self) -> Known:
        """What formulas know of it: nothing where no unit was written."""
        return self.known if self.known.stated else UNKNOWN

    def written(self) -> Quantity:
        """As a quantity with the unit that it had."""
        return Quantity(float(self), self.known.exponents if self.known.stated else None)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(cls.read)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "a number, or a formula with units"}


def positive(amount: Amount) -> Amount:
    """Refuse a number that is zero or less.

    Raises
    ------
    FormulaError
    """
    if not amount > 0:
        raise FormulaError(f"found {quoted(float(amount))}, expected a number greater than zero")
    return amount
