"""Joints, motions and other constraints.  MSC Adams/Solver, JOINT, JPRIM, GCON, MOTION, COUPLER and GEAR statements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..functions.function import Function, required_function
from .arguments import Arguments, Numbered, number
from .text import Statement
from .units import Units

JOINT_KINDS = (
    "REVOLUTE", "TRANSLATIONAL", "CYLINDRICAL", "SPHERICAL", "FIXED", "UNIVERSAL", "HOOKE", "PLANAR", "SCREW", "CONVEL",
    "RACKPIN",
)  # fmt: skip
PRIMITIVES = ("ATPOINT", "INLINE", "INPLANE", "ORIENTATION", "PARALLEL_AXES", "PERPENDICULAR")
COEFFICIENTS = ("MU_DYN_ROT", "MU_STAT_ROT", "MU_DYN_TRANS", "MU_STAT_TRANS", "MUDYNAMIC", "MUSTATIC")
WITHOUT_FRICTION = (
    *COEFFICIENTS, "FRICTION", "DELTA_V", "MAXIMUM_DEFORMATION", "MAXDEFORMATION", "MAX_FRIC_ROT", "INNER_RADIUS",
    "OUTER_RADIUS", "HEIGHT", "WIDTH", "PRELOAD_RADIAL", "PRELOAD_AXIAL", "PRELOAD_X", "PRELOAD_Y",
)  # fmt: skip
"""JOINT arguments for friction in old Adams versions, ignored if friction is off or its coefficients are zero."""
COMPONENTS = ("X", "Y", "Z", "B1", "B2", "B3")
ROTATIONAL, TRANSLATIONAL = "ROTATIONAL", "TRANSLATIONAL"
Start = tuple[str, float | None, float | None]
"""Initial condition of a joint: sort, displacement, velocity."""


@dataclass(frozen=True)
class Joint(Numbered):
    """Joint or primitive between two markers.

    Attributes
    ----------
    kind : str
        One of `JOINT_KINDS` or `PRIMITIVES`.
    i, j : int
        Markers.
    pitch : float
        Pitch of a screw, m per turn.
    diameter : float
        Pitch diameter of a pinion, m.
    start : tuple of (str, float or None, float or None)
        Initial conditions: rotational or translational, displacement and velocity, rad or m, per s; None if not given.
    """

    kind: str
    i: int
    j: int
    pitch: float = 0.0
    diameter: float = 0.0
    start: tuple[Start, ...] = ()


@dataclass(frozen=True)
class GeneralConstraint(Numbered):
    """Expression that stays zero; the reaction is reported on marker `i`."""

    function: Function
    i: int | None


@dataclass(frozen=True)
class Motion(Numbered):
    """Prescribed motion of a joint, or of one component between two markers.

    Attributes
    ----------
    sort : str or None
        Rotational or translational, if given.
    component : str or None
        One of `COMPONENTS`.
    order : int
        Order of the prescribed derivative: 0, 1 or 2.
    start : tuple of float
        Initial displacement and velocity, in the dataset's units; None if not given.
    """

    function: Function
    order: int
    joint: int | None = None
    sort: str | None = None
    i: int | None = None
    j: int | None = None
    component: str | None = None
    start: tuple[float | None, float | None] = (None, None)


@dataclass(frozen=True)
class Coupler(Numbered):
    """Linear equation: the sum of scales times joint displacements is zero; the scales are those of the dataset."""

    joints: tuple[int, ...]
    sorts: tuple[str | None, ...]
    scales: tuple[float, ...]


@dataclass(frozen=True)
class Gear(Numbered):
    """Two joints on one carrier whose parts have equal velocity at a marker, along its z axis."""

    joints: tuple[int, int]
    contact: int


def read_joint(statement: Statement, units: Units) -> Joint:
    """Read a joint between two markers."""
    names = (*JOINT_KINDS, "I", "J", "PITCH", "PD", "IC", "ICROT", "ICTRAN", *WITHOUT_FRICTION)
    found = Arguments(statement, "JOINT", names)
    _refuse_friction(found)
    kind = found.one_of(*JOINT_KINDS)
    if kind is None:
        raise found.fault(f"found no kind of joint, expected one of {', '.join(JOINT_KINDS)}")
    pitch, diameter = (
        found.number(name) if kind == own else None for own, name in (("SCREW", "PITCH"), ("RACKPIN", "PD"))
    )
    for wanted, name, value in (("SCREW", "PITCH", pitch), ("RACKPIN", "PD", diameter)):
        if kind == wanted and not value:
            raise found.fault(f"found no {name}, expected a number other than zero", found.line(name))
    return Joint(
        *found.head(), kind, found.required("I"), found.required("J"),
        (pitch or 0.0) * units.length, (diameter or 0.0) * units.length, tuple(_starts(found, kind, units)),
    )  # fmt: skip


def _refuse_friction(found: Arguments) -> None:
    """Refuse friction of old Adams versions, whose law is not published."""
    found.without_effect(*WITHOUT_FRICTION)
    is_off = (found.text("FRICTION") or "").strip().upper() == "OFF"
    for name in COEFFICIENTS:
        if not is_off and found.number(name):
            raise found.fault(
                f"found {name} = {found.text(name)}, friction of old versions whose law is not published, expected a "
                "FRICTION statement",
                found.line(name),
            )


_STARTS = {
    "REVOLUTE": {"IC": ROTATIONAL, "ICROT": ROTATIONAL},
    "TRANSLATIONAL": {"IC": TRANSLATIONAL, "ICTRAN": TRANSLATIONAL},
    "CYLINDRICAL": {"ICROT": ROTATIONAL, "ICTRAN": TRANSLATIONAL},
}
"""Initial conditions allowed by kind of joint."""


def _starts(found: Arguments, kind: str, units: Units) -> Iterator[Start]:
    allowed = _STARTS.get(kind, {})
    for name in ("IC", "ICROT", "ICTRAN"):
        if name not in found:
            continue
        if name not in allowed:
            raise found.fault(
                f"found {name} of a {kind} joint, expected {' or '.join(allowed) or 'none'}", found.line(name)
            )
        length = units.length if allowed[name] == TRANSLATIONAL else 1.0
        displacement, velocity = _displacement_and_velocity(found, name)
        yield (
            allowed[name],
            None if displacement is None else displacement * length,
            None if velocity is None else velocity * length / units.time,
        )


def _displacement_and_velocity(found: Arguments, name: str) -> tuple[float | None, float | None]:
    """Return displacement and velocity of an initial condition: ``IC = 0.1``, ``IC = 0.1, 2`` or ``IC = , 2``."""
    texts = found.texts(name)
    if len(texts) == 2 and not texts[0] and (velocity := number(texts[1])) is not None:
        return None, velocity
    values = found.numbers(name, 1, 2) or (0.0,)
    return values[0], values[1] if len(values) > 1 else None


def read_primitive(statement: Statement, units: Units) -> Joint:
    """Read a joint primitive between two markers."""
    found = Arguments(statement, "JPRIM", (*PRIMITIVES, "I", "J"))
    kind = found.one_of(*PRIMITIVES)
    if kind is None:
        raise found.fault(f"found no kind of primitive, expected one of {', '.join(PRIMITIVES)}")
    return Joint(*found.head(), kind, found.required("I"), found.required("J"))


def read_general_constraint(statement: Statement, units: Units) -> GeneralConstraint:
    """Read an expression that stays zero."""
    found = Arguments(statement, "GCON", ("I", "FUNCTION", "ROUTINE"), ("FUNCTION",))
    function = required_function(found, "FUNCTION")
    return GeneralConstraint(*found.head(), function, found.reference("I"))


_MOTION = (
    "JOINT", "I", "J", *COMPONENTS, ROTATIONAL, TRANSLATIONAL, "DISPLACEMENT", "VELOCITY", "ACCELERATION", "ICDISP",
    "ICVEL", "FUNCTION", "ROUTINE",
)  # fmt: skip


def read_motion(statement: Statement, units: Units) -> Motion:
    """Read a prescribed motion."""
    found = Arguments(statement, "MOTION", _MOTION, ("FUNCTION",))
    component = found.one_of(*COMPONENTS)
    order = found.one_of("DISPLACEMENT", "VELOCITY", "ACCELERATION") or "DISPLACEMENT"
    joint, i, j = (found.reference(name) for name in ("JOINT", "I", "J"))
    if joint is None and None in (i, j, component):
        raise found.fault(f"found no JOINT, expected JOINT, or I and J with one of {', '.join(COMPONENTS)}")
    return Motion(
        *found.head(), required_function(found, "FUNCTION"),
        ("DISPLACEMENT", "VELOCITY", "ACCELERATION").index(order), joint, found.one_of(ROTATIONAL, TRANSLATIONAL),
        i, j, component, (found.number("ICDISP"), found.number("ICVEL")),
    )  # fmt: skip


def read_coupler(statement: Statement, units: Units) -> Coupler:
    """Read a linear equation of two or three joint displacements; a missing first scale is 1."""
    found = Arguments(statement, "COUPLER", ("JOINTS", "TYPE", "SCALES", "FUNCTION", "ROUTINE"))
    if "FUNCTION" in found:
        raise found.fault("found FUNCTION, which is computed by a subroutine, expected SCALES", found.line("FUNCTION"))
    joints = found.idents("JOINTS", 2, 3)
    scales = found.numbers("SCALES", len(joints) - 1, len(joints))
    if not joints or scales is None:
        raise found.fault("found no JOINTS or no SCALES, expected two or three joints and their scales")
    scales = (*(1.0,) * (len(joints) - len(scales)), *scales)
    sorts = tuple(_sort(found, letter) for letter in (found.text("TYPE") or "").split(":") if letter.strip())
    if sorts and len(sorts) != len(joints):
        raise found.fault(f"found TYPE = {found.text('TYPE')}, expected T or R for every joint", found.line("TYPE"))
    return Coupler(*found.head(), joints, sorts or (None,) * len(joints), scales)


def _sort(found: Arguments, letter: str) -> str:
    for sort in (ROTATIONAL, TRANSLATIONAL):
        if sort.startswith(letter.strip().upper()):
            return sort
    raise found.fault(f"found TYPE = {found.text('TYPE')}, expected T or R for every joint", found.line("TYPE"))


def read_gear(statement: Statement, units: Units) -> Gear:
    """Read a pair of gears of revolute, translational or cylindrical joints."""
    found = Arguments(statement, "GEAR", ("JOINTS", "J1", "J2", "CV"))
    joints = found.idents("JOINTS", 2) or (*found.idents("J1", 1), *found.idents("J2", 1))
    if len(joints) != 2:
        raise found.fault("found no JOINTS, expected the two joints that the gear ties")
    return Gear(*found.head(), (joints[0], joints[1]), found.required("CV"))
