"""Curves, point-on-curve and curve-to-curve constraints.  MSC Adams/Solver, CURVE, PTCV and CVCV statements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

from .arguments import Arguments
from .declared import Numbered, ident, read_by
from .outputs import FEWEST_POINTS
from .text import DatasetFault, Statement
from .units import Units

VELOCITIES = ("VELOCITY", "VX", "VY", "VZ")
UNSUPPORTED = "the velocities of the parts instead"


def _unread(found: Arguments, _: Units) -> str:
    if "FUNCTION" in found:
        return "found FUNCTION, a user subroutine"
    if "CURVE_POINTS" not in found and "CONTROL_POINTS" in found:
        return "found CONTROL_POINTS"
    if "MATRIX" not in found:
        return "found no MATRIX"
    return "" if (found.number("ORDER") or FEWEST_POINTS) == FEWEST_POINTS else f"found ORDER = {found.text('ORDER')}"


@dataclass(frozen=True)
class SpaceCurve(Numbered):
    """Curve through the rows of `matrix`; `unread` is the reason why constraints cannot use it (else empty)."""

    closed: bool = read_by(lambda found, _: found.one_of("CLOSED", "OPEN") == "CLOSED", "CLOSED", "OPEN")
    matrix: int = read_by(lambda found, _: found.reference("MATRIX") or 0, "CURVE_POINTS", "CONTROL_POINTS", "MATRIX")
    unread: str = read_by(_unread, "ORDER", "FUNCTION")
    others = ("ROUTINE",)
    ignored = dict.fromkeys(("MINPAR", "MAXPAR"), "of a subroutine")

    @classmethod
    def read(cls, keyword: str, statement: Statement, units: Units) -> Self:
        """Read a curve; unsupported properties are an error only if a constraint uses it."""
        try:
            return super().read(keyword, statement, units)
        except DatasetFault as fault:
            bare = super().read(keyword, replace(statement, pieces=(), changes=()), units)
            return replace(bare, unread=fault.reason)


@dataclass(frozen=True)
class FirstContact:
    """Initial contact point on a curve, m, in the axes of a marker."""

    point: tuple[float, ...]
    axes: int


def _first_contact(found: Arguments, side: str, units: Units) -> FirstContact | None:
    """Return the initial contact point of DISPLACEMENT, in the axes of ICM or of the curve."""
    point = found.numbers(f"{side}DISPLACEMENT", 3)
    if point is None:
        return None
    axes = found.reference(f"{side}ICM") or found.required(f"{side}RM")
    return FirstContact(tuple(x * units.length for x in point), axes)


@dataclass(frozen=True)
class PointOnCurve(Numbered):
    """Constraint of marker I to a curve in the axes of marker `axes`; the reaction acts on the floating marker."""

    curve: int = ident("CURVE")
    i: int = ident("I")
    floating: int = ident("JFLOAT")
    axes: int = ident("RM")
    start: FirstContact | None = read_by(lambda found, units: _first_contact(found, "", units), "DISPLACEMENT", "ICM")
    ignored = dict.fromkeys(("NODISPLACEMENT", "NOVELOCITY"), "parts start where they are drawn")
    refused = dict.fromkeys(VELOCITIES, UNSUPPORTED)


def _of_sides(name: str) -> tuple[int, int]:
    """Declare the numbers of statements of sides I and J."""
    names = f"I{name}", f"J{name}"
    return read_by(lambda found, _: (found.required(names[0]), found.required(names[1])), *names)


@dataclass(frozen=True)
class CurveOnCurve(Numbered):
    """Contact of two curves, each in the axes of a marker, with a floating marker on each side at the contact."""

    curves: tuple[int, int] = _of_sides("CURVE")
    floating_markers: tuple[int, int] = _of_sides("FLOAT")
    axes: tuple[int, int] = _of_sides("RM")
    starts: tuple[FirstContact | None, ...] = read_by(
        lambda found, units: tuple(_first_contact(found, side, units) for side in "IJ"),
        "IDISPLACEMENT", "IICM", "JDISPLACEMENT", "JICM",
    )  # fmt: skip
    refused = dict.fromkeys((side + name for side in "IJ" for name in VELOCITIES), UNSUPPORTED)

    @property
    def i(self) -> int:
        """Floating marker on the first curve."""
        return self.floating_markers[0]

    @property
    def floating(self) -> int:
        """Floating marker on the second curve."""
        return self.floating_markers[1]
