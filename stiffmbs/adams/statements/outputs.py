"""Requests, variables, arrays and splines.  MSC Adams/Solver, REQUEST, VARIABLE, ARRAY and SPLINE statements."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from ..functions.expression import parse
from ..functions.function import Function, is_subroutine, read_any_function, read_function, required_function
from .arguments import Arguments, Numbered
from .text import Statement
from .units import Units

FEWEST_POINTS = 4
"""Smallest number of points of a spline or a curve."""
SORTS = ("DISPLACEMENT", "VELOCITY", "ACCELERATION", "FORCE")
COLUMNS = tuple(f"F{k}" for k in range(1, 9))
FUNCTIONS = (*COLUMNS, "FUNCTION")


@dataclass(frozen=True)
class Request(Numbered):
    """Quantities to report.

    Attributes
    ----------
    sort : str or None
        One of `SORTS`, between markers `i` and `j` (None is ground), in the axes of marker `axes` (None is ground).
    functions : tuple of (str, Function)
        Functions by column (or FUNCTION), instead of a sort.
    computed : tuple of str
        Columns computed by a user subroutine, which are ignored.
    names : tuple of str
        Column names, if given.
    """

    sort: str | None
    i: int | None
    j: int | None
    axes: int | None
    functions: tuple[tuple[str, Function], ...]
    computed: tuple[str, ...]
    names: tuple[str, ...]
    comment: str


@dataclass(frozen=True)
class Variable(Numbered):
    """Named expression, with an initial guess if it depends on itself."""

    function: Function
    start: float = 0.0

    @property
    def state(self) -> str:
        """Name of its state in the scene if it depends on itself."""
        return f"{self.name}_value"


@dataclass(frozen=True)
class Spline(Numbered):
    """Points of a curve with increasing arguments, in the dataset's units."""

    x: tuple[float, ...]
    y: tuple[float, ...]
    lines_outside: bool


@dataclass(frozen=True)
class Array(Numbered):
    """List of numbers, or of VARIABLEs that are the inputs of a system."""

    numbers: tuple[float, ...]
    variables: tuple[int, ...] = ()


_REQUEST = (
    *SORTS, "I", "J", "RM", "COMMENT", *COLUMNS, "FUNCTION", "TITLE", "CNAMES", "CUNITS", "CLABELS", "RESULTS_NAME", "VARIABLES",
    "ROUTINE",
)  # fmt: skip


def read_request(statement: Statement, units: Units) -> Request:
    """Read a request of displacements, velocities, accelerations or forces between markers, or of functions."""
    found = Arguments(statement, "REQUEST", _REQUEST, FUNCTIONS)
    sort = found.one_of(*SORTS)
    i, j, axes = (found.reference(name) or None for name in ("I", "J", "RM"))
    computed = tuple(column for column in FUNCTIONS if is_subroutine(found, column))
    read = {column: read_function(found, column) for column in FUNCTIONS if column not in computed}
    functions = tuple((column, function) for column, function in read.items() if function is not None)
    functions += tuple(_of_variable(found, ident) for ident in found.idents("VARIABLES"))
    if sort is None and not functions and not computed:
        raise found.fault(f"found no quantity, expected one of {', '.join(SORTS)} or {COLUMNS[1]} = an expression")
    if sort is not None and i is None:
        raise found.fault(f"found no I, expected the marker whose {sort.lower()} is asked for")
    return Request(
        *found.head(), sort, i, j, axes,
        functions, computed, tuple(text.strip().strip("\"'") for text in found.texts("CNAMES")), found.text("COMMENT") or "",
    )  # fmt: skip


def _of_variable(found: Arguments, ident: int) -> tuple[str, Function]:
    """Return a column that reports a variable."""
    text = f"VARVAL({ident})"
    return f"VARIABLE_{ident}", Function(text, parse(text), found.line("VARIABLES"), found.label)


def read_variable(statement: Statement, units: Units) -> Variable:
    """Read a named expression."""
    found = Arguments(statement, "VARIABLE", ("IC", "FUNCTION", "ROUTINE"), ("FUNCTION",))
    reader = read_any_function if is_subroutine(found, "FUNCTION") else required_function
    return Variable(*found.head(), reader(found, "FUNCTION"), found.number("IC") or 0.0)


def read_spline(statement: Statement, units: Units) -> Spline:
    """Read a curve by points."""
    found = Arguments(statement, "SPLINE", ("X", "Y", "LINEAR_EXTRAPOLATE", "FILE", "BLOCK", "CHANNEL"))
    if "FILE" in found:
        raise found.fault("found FILE, expected the points in X and Y", found.line("FILE"))
    x, y = found.numbers("X"), found.numbers("Y")
    if x is None or y is None or len(x) != len(y):
        raise found.fault(f"found {len(x or ())} X and {len(y or ())} Y, expected as many of each")
    if len(x) < FEWEST_POINTS or any(after <= before for before, after in itertools.pairwise(x)):
        raise found.fault("found less than four X or such that do not increase, expected four or more increasing ones")
    return Spline(*found.head(), x, y, "LINEAR_EXTRAPOLATE" in found)


def read_array(statement: Statement, units: Units) -> Array:
    """Read a list of numbers, or the states, inputs or outputs of a system."""
    found = Arguments(statement, "ARRAY", ("IC", "SIZE", "NUMBERS", "X", "Y", "U", "VARIABLES"))
    return Array(
        *found.head(),
        found.numbers("NUMBERS") or (),
        found.idents("VARIABLES"),
    )
