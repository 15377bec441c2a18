"""Curves, point-on-curve and curve-to-curve constraints.  MSC Adams/Solver, CURVE, PTCV and CVCV statements."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .arguments import Arguments, Numbered
from .text import DatasetFault, Statement
from .units import Units

CUBIC = 4
"""Default ORDER of a curve: polynomial degree plus one."""
WITHOUT_EFFECT = ("NODISPLACEMENT", "NOVELOCITY")
_STARTS = ("DISPLACEMENT", "ICM")
_PAIR_STARTS = tuple(side + name for side in "IJ" for name in _STARTS)
_VELOCITIES = ("VELOCITY", "VX", "VY", "VZ")
_PAIR_VELOCITIES = tuple(side + name for side in "IJ" for name in _VELOCITIES)
UNSUPPORTED = "the velocities of the parts instead"


@dataclass(frozen=True)
class SpaceCurve(Numbered):
    """Curve through the rows of `matrix`; `unread` is the reason why constraints cannot use it (else empty)."""

    matrix: int
    closed: bool
    unread: str = ""


@dataclass(frozen=True)
class FirstContact:
    """Initial contact point on a curve, m, in the axes of a marker."""

    point: tuple[float, ...]
    axes: int


@dataclass(frozen=True)
class PointOnCurve(Numbered):
    """Constraint of marker I to a curve in the axes of marker `axes`; the reaction acts on the floating marker."""

    curve: int
    i: int
    floating: int
    axes: int
    start: FirstContact | None = None


@dataclass(frozen=True)
class CurveOnCurve(Numbered):
    """Contact of two curves, each in the axes of a marker; `i` and `floating` are floating markers at the contact."""

    curves: tuple[int, int]
    axes: tuple[int, int]
    i: int
    floating: int
    starts: tuple[FirstContact | None, FirstContact | None] = (None, None)


def read_curve(statement: Statement, units: Units) -> SpaceCurve:
    """Read a curve; unsupported properties are an error only if a constraint uses it."""
    try:
        found = Arguments(statement, "CURVE", _CURVE, ("FUNCTION",))
        matrix = found.reference("MATRIX") or 0
        closed, unread = found.one_of("CLOSED", "OPEN") == "CLOSED", _unread(found)
    except DatasetFault as fault:
        found = Arguments(replace(statement, pieces=()), "CURVE", ())
        matrix, closed, unread = 0, False, fault.reason
    return SpaceCurve(*found.head(), matrix, closed, unread)


_CURVE = (
    "CLOSED", "OPEN", "CURVE_POINTS", "CONTROL_POINTS", "MATRIX", "ORDER", "FUNCTION", "ROUTINE", "MINPAR", "MAXPAR",
)  # fmt: skip


def _unread(found: Arguments) -> str:
    """Return the reason why constraints cannot use a curve; '' if they can."""
    if "FUNCTION" in found:
        return "found FUNCTION, which is computed by a subroutine"
    if "CONTROL_POINTS" in found:
        return "found CONTROL_POINTS"
    if "MATRIX" not in found:
        return "found no MATRIX"
    return "" if (found.number("ORDER") or CUBIC) == CUBIC else f"found ORDER = {found.text('ORDER')}"


def read_point_on_curve(statement: Statement, units: Units) -> PointOnCurve:
    """Read a point-on-curve constraint."""
    found = Arguments(statement, "PTCV", ("CURVE", "I", "JFLOAT", "RM", *WITHOUT_EFFECT, *_STARTS, *_VELOCITIES))
    found.refuse(_VELOCITIES, UNSUPPORTED)
    return PointOnCurve(
        *found.head(), found.required("CURVE"), found.required("I"),
        found.required("JFLOAT"), found.required("RM"), _first_contact(found, "", found.required("RM"), units),
    )  # fmt: skip


def read_curve_on_curve(statement: Statement, units: Units) -> CurveOnCurve:
    """Read a curve-to-curve constraint."""
    names = tuple(side + name for name in ("CURVE", "FLOAT", "RM") for side in "IJ")
    found = Arguments(statement, "CVCV", (*names, *_PAIR_STARTS, *_PAIR_VELOCITIES))
    found.refuse(_PAIR_VELOCITIES, UNSUPPORTED)
    first, second, i, j, own, other = (found.required(name) for name in names)
    starts = _first_contact(found, "I", own, units), _first_contact(found, "J", other, units)
    return CurveOnCurve(*found.head(), (first, second), (own, other), i, j, starts)


def _first_contact(found: Arguments, side: str, axes: int, units: Units) -> FirstContact | None:
    """Return the initial contact point of DISPLACEMENT, in the axes of ICM or of the curve."""
    point = found.numbers(f"{side}DISPLACEMENT", 3)
    if point is None:
        return None
    return FirstContact(tuple(x * units.length for x in point), found.reference(f"{side}ICM") or axes)
