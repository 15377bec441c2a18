"""Systems with states: DIFF, LSE, TFSISO, their MATRIX statements, PINPUT and POUTPUT.  MSC Adams/Solver."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function
from .arguments import Arguments
from .declared import Numbered, expression, given, ident, ident_or_none, read_by
from .units import Units

Rows = tuple[tuple[float, ...], ...]
NO_STATICS = {"STATIC_HOLD": "in statics states find their own equilibrium"}


def _starts(found: Arguments, _: Units) -> tuple[float, float]:
    start, rate = (*(found.numbers("IC", 1, 2) or (0.0,)), 0.0)[:2]
    return start, rate


@dataclass(frozen=True)
class Differential(Numbered):
    """State with an explicit or implicit differential equation.

    `function`: rate per unit of time of the dataset; for an implicit equation a residual with the rate as DIF1.
    `starts`: initial values of the state, and guess of the rate of an implicit equation.
    """

    starts: tuple[float, float] = read_by(_starts, "IC")
    function: Function = expression("FUNCTION")
    implicit: bool = given("IMPLICIT")
    others = ("ROUTINE",)
    ignored = NO_STATICS

    @property
    def rate(self) -> str:
        """Name of the rate of an implicit equation in the scene."""
        return f"{self.name}_rate"


def _rows(found: Arguments, _: Units) -> Rows:
    values = found.numbers("VALUES") or ()
    if found.one_of("FULL", "SPARSE") == "SPARSE":
        return _from_entries(found, values)
    rows, columns = _size(found)
    if rows < 1 or columns < 1 or len(values) != rows * columns:
        raise found.fault(f"found {len(values)} VALUES, M = {rows} and N = {columns}, expected M N VALUES")
    by_rows = (found.text("FULL") or "RORDER").strip().upper().startswith("R")
    at = (lambda i, j: i * columns + j) if by_rows else (lambda i, j: j * rows + i)
    return tuple(tuple(values[at(i, j)] for j in range(columns)) for i in range(rows))


def _size(found: Arguments) -> tuple[int, int]:
    """Return M and N, which Adams/View writes as ROWS and COLUMNS; 0 for one that is missing."""
    rows, columns = (found.number(found.one_of(*names) or names[0]) or 0 for names in (("M", "ROWS"), ("N", "COLUMNS")))
    return int(rows), int(columns)


def _from_entries(found: Arguments, values: tuple[float, ...]) -> Rows:
    rows, columns = found.idents("I"), found.idents("J")
    if not values or len(rows) != len(values) or len(columns) != len(values) or 0 in (*rows, *columns):
        raise found.fault(
            f"found {len(rows)} I, {len(columns)} J and {len(values)} VALUES, expected equal numbers, I and J from 1 on"
        )
    entries = dict(zip(zip(rows, columns, strict=True), values, strict=True))
    high, wide = (max(count, *at) for count, at in zip(_size(found), (rows, columns), strict=True))
    return tuple(tuple(entries.get((i, j), 0.0) for j in range(1, wide + 1)) for i in range(1, high + 1))


@dataclass(frozen=True)
class Matrix(Numbered):
    """Full or sparse matrix by rows."""

    rows: Rows = read_by(_rows, "FULL", "SPARSE", "M", "N", "ROWS", "COLUMNS", "VALUES", "I", "J")
    ignored = dict.fromkeys(("NAME", "UNITS"), "text")
    refused = {"FILE": "the numbers in VALUES"}


@dataclass(frozen=True)
class LinearSystem(Numbered):
    """x' = A x + B u, y = C x + D u: numbers of MATRIX and ARRAY statements, None if missing."""

    x: int = ident("X")
    u: int | None = ident_or_none("U")
    y: int | None = ident_or_none("Y")
    start: int | None = ident_or_none("IC")
    a: int = ident("A")
    b: int | None = ident_or_none("B")
    c: int | None = ident_or_none("C")
    d: int | None = ident_or_none("D")
    ignored = NO_STATICS

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse inputs without their matrix."""
        if ("U" in found) != ("B" in found):
            raise found.fault("found one of U and B, expected both or neither")


@dataclass(frozen=True)
class TransferFunction(Numbered):
    """y = numerator(s)/denominator(s) u; coefficients in ascending powers of s, in the dataset's units."""

    x: int = ident("X")
    u: int = ident("U")
    y: int = ident("Y")
    numerator: tuple[float, ...] = read_by(lambda found, _: found.numbers("NUMERATOR") or (), "NUMERATOR")
    denominator: tuple[float, ...] = read_by(lambda found, _: found.numbers("DENOMINATOR") or (), "DENOMINATOR")
    ignored = NO_STATICS

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a transfer function that is not proper."""
        numerator, denominator = found.numbers("NUMERATOR"), found.numbers("DENOMINATOR")
        if not numerator or not denominator or len(numerator) > len(denominator) or not denominator[-1]:
            raise found.fault(
                "found no proper transfer function, expected NUMERATOR and at least as many numbers of DENOMINATOR, the "
                "last not zero"
            )


def _variables(found: Arguments, _: Units) -> tuple[int, ...]:
    variables = found.idents("VARIABLES")
    if not variables:
        raise found.fault("found no VARIABLES, expected the numbers of VARIABLE statements")
    return variables


@dataclass(frozen=True)
class Plant(Numbered):
    """VARIABLEs that are inputs (PINPUT) or outputs (POUTPUT), in order."""

    variables: tuple[int, ...] = read_by(_variables, "VARIABLES")
