"""Inputs: named values for formulas, set by another program."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..formula.dimension import UNKNOWN, Known, known_of
from ..formula.formula import Formula
from ..formula.nodes import TIME
from ..formula.text import FormulaError
from ..table import Table
from ..units.quantity import quantity
from .amount import Amount

TABLE = "values"


class _InputField:
    """Marker of a field for the value of an input: a number, or a table of time."""

    @staticmethod
    def read(found: Any, info: ValidationInfo) -> Amount | Table:
        """Return the value given in the scene."""
        if isinstance(found, Table):
            return found
        return (
            Table.model_validate(found, context=info.context) if isinstance(found, dict) else Amount.read(found, info)
        )

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(cls.read)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        number = Amount.__get_pydantic_json_schema__(schema, handler)
        return {"anyOf": [*number["anyOf"], handler(Table.__pydantic_core_schema__)]}


InputValue = Annotated[Any, _InputField]


def formulas_of_inputs(inputs: Mapping[str, Amount | Table]) -> Iterator[tuple[str, Formula]]:
    """Yield the formulas that replace the inputs."""
    for name, value in inputs.items():
        if isinstance(value, Table):
            tree: ast.expr = ast.Call(ast.Name(TABLE), [ast.Name(TIME)], [])
            yield name, Formula(ast.unparse(tree), tree, (), {}, tables={TABLE: value})
        else:
            yield name, Formula(repr(float(value)), ast.Constant(float(value)), (), {})


def dimension_of_input(value: Any, parameters: Any) -> Known:
    """Return the known dimension of an input before its validation."""
    try:
        return known_of(quantity(value, parameters)) if isinstance(value, str) else UNKNOWN
    except FormulaError:
        return UNKNOWN
