"""Systems with states: DIFF, LSE, TFSISO, their MATRIX statements, PINPUT and POUTPUT.  MSC Adams/Solver."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function, required_function
from .arguments import Arguments, Numbered
from .text import Statement
from .units import Units


@dataclass(frozen=True)
class Differential(Numbered):
    """State with an explicit or implicit differential equation.

    `function`: rate per unit of time of the dataset; for an implicit equation a residual with the rate as DIF1.
    `start_of_rate`: initial guess of the rate of an implicit equation.
    """

    function: Function
    start: float
    implicit: bool = False
    start_of_rate: float = 0.0

    @property
    def rate(self) -> str:
        """Name of the rate of an implicit equation in the scene."""
        return f"{self.name}_rate"


@dataclass(frozen=True)
class Matrix(Numbered):
    """Matrix by rows."""

    rows: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class LinearSystem(Numbered):
    """x' = A x + B u, y = C x + D u: numbers of MATRIX and ARRAY statements, None if missing."""

    x: int
    u: int | None
    y: int | None
    a: int
    b: int | None
    c: int | None
    d: int | None
    start: int | None


@dataclass(frozen=True)
class TransferFunction(Numbered):
    """y = numerator(s)/denominator(s) u; coefficients in ascending powers of s, in the dataset's units."""

    x: int
    u: int
    y: int
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]


def read_differential(statement: Statement, units: Units) -> Differential:
    """Read a first-order differential equation, explicit or implicit."""
    found = Arguments(statement, "DIFF", ("IC", "FUNCTION", "ROUTINE", "IMPLICIT", "STATIC_HOLD"), ("FUNCTION",))
    start = (*(found.numbers("IC", 1, 2) or (0.0,)), 0.0)
    return Differential(
        *found.head(), required_function(found, "FUNCTION"), start[0],
        "IMPLICIT" in found, start[1],
    )  # fmt: skip


def read_matrix(statement: Statement, units: Units) -> Matrix:
    """Read a full or sparse matrix."""
    names = ("FULL", "SPARSE", "M", "N", "VALUES", "I", "J", "FILE", "NAME", "UNITS")
    found = Arguments(statement, "MATRIX", names)
    if "FILE" in found:
        raise found.fault("found FILE, expected the numbers in VALUES", found.line("FILE"))
    values = found.numbers("VALUES") or ()
    if found.one_of("FULL", "SPARSE") == "SPARSE":
        return Matrix(*found.head(), _from_entries(found, values))
    rows, columns = (int(found.number(name) or 0) for name in ("M", "N"))
    if rows < 1 or columns < 1 or len(values) != rows * columns:
        raise found.fault(f"found {len(values)} VALUES of {rows} rows and {columns} columns, expected as many of each")
    by_rows = (found.text("FULL") or "RORDER").strip().upper().startswith("R")
    at = (lambda i, j: i * columns + j) if by_rows else (lambda i, j: j * rows + i)
    whole = tuple(tuple(values[at(i, j)] for j in range(columns)) for i in range(rows))
    return Matrix(*found.head(), whole)


def _from_entries(found: Arguments, values: tuple[float, ...]) -> tuple[tuple[float, ...], ...]:
    rows, columns = found.idents("I"), found.idents("J")
    if not values or len(rows) != len(values) or len(columns) != len(values) or 0 in (*rows, *columns):
        raise found.fault("found other numbers of I, J and VALUES, expected as many of each, I and J from 1 on")
    entries = dict(zip(zip(rows, columns, strict=True), values, strict=True))
    high, wide = (max(int(found.number(name) or 0), *at) for name, at in (("M", rows), ("N", columns)))
    return tuple(tuple(entries.get((i, j), 0.0) for j in range(1, wide + 1)) for i in range(1, high + 1))


def read_linear_system(statement: Statement, units: Units) -> LinearSystem:
    """Read a linear system."""
    found = Arguments(statement, "LSE", ("X", "U", "Y", "IC", "A", "B", "C", "D", "STATIC_HOLD"))
    x, a = found.required("X"), found.required("A")
    u, y, b, c, d, start = (found.reference(name) for name in ("U", "Y", "B", "C", "D", "IC"))
    if (u is None) != (b is None):
        raise found.fault("found one of U and B alone, expected both or neither")
    return LinearSystem(*found.head(), x, u, y, a, b, c, d, start)


def read_transfer_function(statement: Statement, units: Units) -> TransferFunction:
    """Read a transfer function."""
    found = Arguments(statement, "TFSISO", ("X", "U", "Y", "NUMERATOR", "DENOMINATOR", "STATIC_HOLD"))
    numerator, denominator = found.numbers("NUMERATOR"), found.numbers("DENOMINATOR")
    if not numerator or not denominator or len(numerator) > len(denominator) or not denominator[-1]:
        raise found.fault(
            "found no proper transfer function, expected NUMERATOR and at least as many numbers of DENOMINATOR, the last not zero"
        )
    return TransferFunction(
        *found.head(), found.required("X"), found.required("U"),
        found.required("Y"), numerator, denominator,
    )  # fmt: skip


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
