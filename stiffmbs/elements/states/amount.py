"""Numbers of any dimension with the unit in which they were given, and inputs that another program sets."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from ...reading.files.quoted import quoted
from ...reading.formula.dimension import PLAIN, UNKNOWN, Known, known_of
from ...reading.formula.formula import Formula
from ...reading.formula.nodes import TIME
from ...reading.formula.text import FormulaError
from ...reading.table import Table
from ...reading.units.quantity import in_si, quantity
from ...reading.units.units import ANY, Quantity
from ..read_by import Context, ReadBy


class Amount(float):
    """Finite number in SI units, with its known dimension. `known`: a number without a unit can have any dimension."""

    known: Known = PLAIN

    @property
    def dimension(self) -> Known:
        """Dimension for formulas; unknown without a unit."""
        return self.known if self.known.stated else UNKNOWN

    def written(self) -> Quantity:
        """Return a quantity with the original unit."""
        return Quantity(float(self), self.known.exponents if self.known.stated else None)


AMOUNT = {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "a number, or a formula with units"}


def read_amount(found: object, context: Context) -> Amount:
    """Return the number given in a scene or in Python."""
    if isinstance(found, Amount):
        return found
    parameters = (context or {}).get("parameters")
    amount = Amount(in_si(found, ANY, parameters))
    if isinstance(found, str):
        amount.known = known_of(quantity(found, parameters))
    return amount


AnyAmount = Annotated[Amount, ReadBy(read_amount, lambda _: AMOUNT)]


def positive(amount: Amount) -> Amount:
    """Return a positive number, refuse others. Raises FormulaError."""
    if not amount > 0:
        raise FormulaError(f"found {quoted(float(amount))}, expected a number greater than zero")
    return amount


def stated_dimension(found: object, parameters: Any) -> Known:
    """Return the known dimension of an entry before its validation; unknown if it cannot be read."""
    try:
        return known_of(quantity(found, parameters)) if isinstance(found, str) else UNKNOWN
    except FormulaError:
        return UNKNOWN


TABLE = "values"


def _read(found: object, context: Context) -> Amount | Table:
    """Return the value of an input: a number, or a table of time."""
    if isinstance(found, Table | dict):
        return found if isinstance(found, Table) else Table.model_validate(found, context=context)
    return read_amount(found, context)


InputValue = Annotated[Any, ReadBy(_read, lambda schema_of: {"anyOf": [*AMOUNT["anyOf"], schema_of(Table)]})]


def formulas_of_inputs(inputs: Mapping[str, Amount | Table]) -> Iterator[tuple[str, Formula]]:
    """Yield the formulas that replace the inputs."""
    for name, value in inputs.items():
        if isinstance(value, Table):
            tree: ast.expr = ast.Call(ast.Name(TABLE), [ast.Name(TIME)], [])
            yield name, Formula(ast.unparse(tree), tree, (), {}, tables={TABLE: value})
        else:
            yield name, Formula(repr(float(value)), ast.Constant(float(value)), (), {})
