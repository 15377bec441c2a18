"""Numbers of any dimension with the unit in which they were given."""

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
    """Finite number in SI units, with its known dimension.

    Attributes
    ----------
    known : Known
        A number without a unit can have any dimension.
    """

    known: Known = PLAIN

    @classmethod
    def read(cls, found: Any, info: ValidationInfo) -> Amount:
        """Return the number given in a scene or in Python."""
        if isinstance(found, Amount):
            return found
        parameters = (info.context or {}).get("parameters")
        amount = cls(in_si(found, ANY, parameters))
        if isinstance(found, str):
            amount.known = known_of(quantity(found, parameters))
        return amount

    @property
    def dimension(self) -> Known:
        """Dimension for formulas; unknown without a unit."""
        return self.known if self.known.stated else UNKNOWN

    def written(self) -> Quantity:
        """Return a quantity with the original unit."""
        return Quantity(float(self), self.known.exponents if self.known.stated else None)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(cls.read)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "a number, or a formula with units"}


def positive(amount: Amount) -> Amount:
    """Return a positive number, refuse others.

    Raises
    ------
    FormulaError
    """
    if not amount > 0:
        raise FormulaError(f"found {quoted(float(amount))}, expected a number greater than zero")
    return amount
