"""Section `variables` of a scene: formulas by name."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping

from ...errors import InputError, prefixed
from ..fields import named_entries
from ..formula.nodes import TIME
from ..formula.text import UNIT, FormulaError
from ..formula.variables import resolved
from ..units.units import CONSTANTS, UNITS, Quantity
from .quoted import written


def read_variables(
    found: object, parameters: Mapping[str, Quantity], tables: Collection[str], *sections: object
) -> dict[str, ast.expr]:
    """Return the syntax trees of a scene's variables by name; `sections`, of states and inputs, have other names.

    Raise an InputError if a name is not an identifier or already has a meaning, or a formula cannot be read.
    """
    formulas: dict[str, str | float] = {}
    for name, formula in named_entries("variables", found, "formulas"):
        if name in UNITS:
            raise InputError(f"variables.{name}: found the name of a unit, expected another: rename the variable")
        if name in (*CONSTANTS, *parameters, *tables, TIME, UNIT):
            raise InputError(f"variables.{name}: found a name with a meaning already, expected another")
        if isinstance(formula, bool) or not isinstance(formula, str | int | float):
            raise InputError(f"variables.{name}: found {written(formula)}, expected a formula")
        formulas[name] = formula
    with prefixed("variables.", FormulaError):
        known = [name for section in sections if isinstance(section, dict) for name in section]
        return resolved(formulas, {*parameters, *CONSTANTS, TIME, *known})
