"""Inputs and outputs of a model.  MSC Adams/Solver, PINPUT and POUTPUT statements."""

from __future__ import annotations

from dataclasses import dataclass

from .arguments import Arguments, Numbered
from .text import Statement
from .units import Units


@dataclass(frozen=True)
class Plant(Numbered):
    """VARIABLEs that are inputs (PINPUT) or outputs (POUTPUT), in order."""

    variables: tuple[int, ...]


def read_plant(statement: Statement, units: Units, keyword: str) -> Plant:
    """Read the inputs or outputs of a model."""
    found = Arguments(statement, keyword, ("VARIABLES",))
    variables = found.idents("VARIABLES")
    if not variables:
        raise found.fault("found no VARIABLES, expected the numbers of VARIABLE statements")
    return Plant(*found.head(), variables)
