"""Requests, variables, arrays and splines.  MSC Adams/Solver, REQUEST, VARIABLE, ARRAY and SPLINE statements."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Final

from ..functions.expression import parse
from ..functions.function import Function, is_subroutine, read_any_function, read_function, required_function
from .arguments import Arguments
from .declared import Numbered, given, number, one_of_or_none, read_by
from .units import Units

FEWEST_POINTS: Final = 4
"""Smallest number of points of a spline or a curve, which are cubic: degree plus one, the ORDER of a curve."""
SORTS = ("DISPLACEMENT", "VELOCITY", "ACCELERATION", "FORCE")
COLUMNS = tuple(f"F{k}" for k in range(1, 9))
FUNCTIONS = (*COLUMNS, "FUNCTION")


def _marker(name: str) -> int | None:
    """Declare a marker; None for ground."""
    return read_by(lambda found, _: found.reference(name) or None, name)


def _computed(found: Arguments) -> tuple[str, ...]:
    return tuple(column for column in FUNCTIONS if is_subroutine(found, column))


def _functions(found: Arguments, _: Units) -> tuple[tuple[str, Function], ...]:
    read = {column: read_function(found, column) for column in FUNCTIONS if column not in _computed(found)}
    functions = [(column, function) for column, function in read.items() if function is not None]
    for variable in found.idents("VARIABLES"):
        text = f"VARVAL({variable})"
        functions.append((
            f"VARIABLE_{variable}", Function(text, parse(text), found.line("VARIABLES"), found.label),
        ))  # fmt: skip
    return tuple(functions)


@dataclass(frozen=True)
class Request(Numbered):
    """Quantities to report."""

    # one of `SORTS`, between markers `i` and `j` (None is ground), in the axes of marker `axes` (None is ground)
    sort: str | None = one_of_or_none(*SORTS)
    i: int | None = _marker("I")
    j: int | None = _marker("J")
    axes: int | None = _marker("RM")
    comment: str = read_by(lambda found, _: found.text("COMMENT") or "", "COMMENT")
    # functions by column (or FUNCTION), instead of a sort
    functions: tuple[tuple[str, Function], ...] = read_by(_functions, *FUNCTIONS, expressions=True)
    # columns computed by a user subroutine, which are ignored
    computed: tuple[str, ...] = read_by(lambda found, _: _computed(found))
    # column names, if given
    names: tuple[str, ...] = read_by(
        lambda found, _: tuple(text.strip().strip("\"'") for text in found.texts("CNAMES")), "TITLE", "CNAMES"
    )
    others = ("VARIABLES",)
    ignored = {
        **dict.fromkeys(("COMMENT", "TITLE", "CUNITS", "CLABELS", "RESULTS_NAME"), "text"),
        "ROUTINE": "a user subroutine",
    }

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a request without a quantity."""
        sort = found.one_of(*SORTS)
        if sort is None and not (found.idents("VARIABLES") or any(column in found for column in FUNCTIONS)):
            raise found.fault(f"found no quantity, expected one of {', '.join(SORTS)} or {COLUMNS[1]} = an expression")
        others = [column for column in (*FUNCTIONS, "VARIABLES") if column in found]
        if sort is not None and others:
            raise found.fault(f"found {sort} and {others[0]}, expected one of them")
        if sort is not None and not found.reference("I"):
            raise found.fault(f"found no I, expected the marker whose {sort.lower()} is requested")


def _of_variable(found: Arguments, _: Units) -> Function:
    reader = read_any_function if is_subroutine(found, "FUNCTION") else required_function
    return reader(found, "FUNCTION")


@dataclass(frozen=True)
class Variable(Numbered):
    """Named expression, with an initial guess if it depends on itself."""

    start: float = number("IC")
    function: Function = read_by(_of_variable, "FUNCTION")
    others = ("ROUTINE",)

    @property
    def state(self) -> str:
        """Name of its state in the scene if it depends on itself."""
        return f"{self.name}_value"


def _families(found: Arguments, _: Units) -> tuple[tuple[float, ...], ...]:
    """Return the values of each argument Y: of a family, its z and a curve, otherwise the only curve."""
    x, y = found.numbers("X") or (), found.numbers("Y") or ()
    count = len(x) + (len(y) != len(x))
    return tuple(y[k : k + count] for k in range(0, len(y), count))


@dataclass(frozen=True)
class Spline(Numbered):
    """Curve of points with increasing arguments, or a family of curves with increasing `z`, in the dataset's units."""

    x: tuple[float, ...] = read_by(lambda found, _: found.numbers("X") or (), "X")
    families: tuple[tuple[float, ...], ...] = read_by(_families, "Y")
    lines_outside: bool = given("LINEAR_EXTRAPOLATE")
    ignored = dict.fromkeys(("BLOCK", "CHANNEL"), "of a file")
    refused = {"FILE": "the points in X and Y"}
    repeated = ("Y",)

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse points that do not define a curve."""
        x, y = found.numbers("X") or (), found.numbers("Y") or ()
        several = len(y) > len(x) + 1 and len(y) % (len(x) + 1) == 0
        if not x or not y or not (len(x) == len(y) or several):
            raise found.fault(
                f"found {len(x)} X and {len(y)} Y, expected equal numbers, or for a family of curves a Y for each curve: z, then a value for each X"
            )
        z = y[:: len(x) + 1] if several else ()
        if len(x) < FEWEST_POINTS or any(b <= a for values in (x, z) for a, b in itertools.pairwise(values)):
            raise found.fault(
                "found fewer than four X, or X or z that do not increase, expected four or more increasing ones, and "
                "increasing z of a family"
            )

    @property
    def z(self) -> tuple[float, ...]:
        """Second argument of each curve of a family; empty for a single curve."""
        return tuple(family[0] for family in self.families if len(family) > len(self.x))

    @property
    def curves(self) -> tuple[tuple[float, ...], ...]:
        """Values of each curve."""
        return tuple(family[-len(self.x) :] for family in self.families)


@dataclass(frozen=True)
class Array(Numbered):
    """List of numbers, or of VARIABLEs that are the inputs of a system."""

    numbers: tuple[float, ...] = read_by(lambda found, _: found.numbers("NUMBERS") or (), "IC", "SIZE", "NUMBERS")
    variables: tuple[int, ...] = read_by(lambda found, _: found.idents("VARIABLES"), "X", "Y", "U", "VARIABLES")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Exclude the role of an array, which its users state too, from the notes; refuse a SIZE that contradicts its list."""
        found.without_effect("IC", "X", "Y", "U")
        size, count = found.number("SIZE"), len(found.texts("NUMBERS") or found.texts("VARIABLES"))
        if size is not None and count and size != count:
            raise found.fault(f"found SIZE = {found.text('SIZE')} and {count} entries, expected equal numbers", "SIZE")
