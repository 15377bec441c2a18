"""Joints, motions and other constraints.  MSC Adams/Solver, JOINT, JPRIM, GCON, MOTION, COUPLER and GEAR statements."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function
from .arguments import Arguments
from .arguments import number as plain_number
from .declared import Numbered, expression, ident, ident_or_none, one_of, one_of_or_none, read_by
from .units import Units

JOINT_KINDS = (
    "REVOLUTE", "TRANSLATIONAL", "CYLINDRICAL", "SPHERICAL", "FIXED", "UNIVERSAL", "HOOKE", "PLANAR", "SCREW", "CONVEL",
    "RACKPIN",
)  # fmt: skip
PRIMITIVES = ("ATPOINT", "INLINE", "INPLANE", "ORIENTATION", "PARALLEL_AXES", "PERPENDICULAR")
COEFFICIENTS = ("MU_DYN_ROT", "MU_STAT_ROT", "MU_DYN_TRANS", "MU_STAT_TRANS", "MUDYNAMIC", "MUSTATIC")
OLD_FRICTION = (
    *COEFFICIENTS, "FRICTION", "DELTA_V", "MAXIMUM_DEFORMATION", "MAXDEFORMATION", "MAX_FRIC_ROT", "INNER_RADIUS",
    "OUTER_RADIUS", "HEIGHT", "WIDTH", "PRELOAD_RADIAL", "PRELOAD_AXIAL", "PRELOAD_X", "PRELOAD_Y",
)  # fmt: skip
"""JOINT arguments for friction in old Adams versions, ignored if friction is off or its coefficients are zero."""
COMPONENTS = ("X", "Y", "Z", "B1", "B2", "B3")
ROTATIONAL, TRANSLATIONAL = "ROTATIONAL", "TRANSLATIONAL"
ORDERS = ("DISPLACEMENT", "VELOCITY", "ACCELERATION")
STARTS = {
    "REVOLUTE": {"IC": ROTATIONAL, "ICROT": ROTATIONAL},
    "TRANSLATIONAL": {"IC": TRANSLATIONAL, "ICTRAN": TRANSLATIONAL},
    "CYLINDRICAL": {"ICROT": ROTATIONAL, "ICTRAN": TRANSLATIONAL},
}
"""Initial conditions allowed by kind of joint."""
Start = tuple[str, float | None, float | None]
"""Initial condition of a joint: sort, displacement, velocity."""


def _length_of(kind: str, name: str) -> float:
    """Declare a length that one kind of joint needs; 0 for the others."""

    def read(found: Arguments, units: Units) -> float:
        value = found.number(name) if kind in found else 0.0
        if kind in found and not value:
            raise found.fault(f"found no {name}, expected a number other than zero", name)
        return (value or 0.0) * units.length

    return read_by(read, name)


def _starts(found: Arguments, units: Units) -> tuple[Start, ...]:
    kind = found.one_of(*JOINT_KINDS) or ""
    allowed, starts = STARTS.get(kind, {}), []
    for name in ("IC", "ICROT", "ICTRAN"):
        if name not in found:
            continue
        if name not in allowed:
            raise found.fault(f"found {name} of a {kind} joint, expected {' or '.join(allowed) or 'none'}", name)
        length = units.length if allowed[name] == TRANSLATIONAL else 1.0
        displacement, velocity = _displacement_and_velocity(found, name)
        starts.append((
            allowed[name],
            None if displacement is None else displacement * length,
            None if velocity is None else velocity * length / units.time,
        ))  # fmt: skip
    return tuple(starts)


def _displacement_and_velocity(found: Arguments, name: str) -> tuple[float | None, float | None]:
    """Return displacement and velocity of an initial condition: ``IC = 0.1``, ``IC = 0.1, 2`` or ``IC = , 2``."""
    texts = found.texts(name)
    if len(texts) == 2 and not texts[0] and (velocity := plain_number(texts[1])) is not None:
        return None, velocity
    values = found.numbers(name, 1, 2) or (0.0,)
    return values[0], values[1] if len(values) > 1 else None


@dataclass(frozen=True)
class Primitive(Numbered):
    """Joint primitive between two markers."""

    kind: str = one_of(*PRIMITIVES, missing=f"found no kind of primitive, expected one of {', '.join(PRIMITIVES)}")
    i: int = ident("I")
    j: int = ident("J")


@dataclass(frozen=True)
class Joint(Primitive):
    """Joint between two markers; pitch (m per turn) of a screw, pitch diameter (m) of a pinion.

    `start`: initial conditions: rotational or translational, displacement and velocity, rad or m, per s; None if not
    given.
    """

    kind: str = one_of(*JOINT_KINDS, missing=f"found no kind of joint, expected one of {', '.join(JOINT_KINDS)}")
    pitch: float = _length_of("SCREW", "PITCH")
    diameter: float = _length_of("RACKPIN", "PD")
    start: tuple[Start, ...] = read_by(_starts, "IC", "ICROT", "ICTRAN")
    ignored = dict.fromkeys(OLD_FRICTION, "friction of old versions, which is off")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse friction of old Adams versions, whose law is not published."""
        found.without_effect(*OLD_FRICTION)
        is_off = (found.text("FRICTION") or "").strip().upper() == "OFF"
        for name in COEFFICIENTS:
            if not is_off and found.number(name):
                raise found.fault(
                    f"found {name} = {found.text(name)}, friction of old versions with an unpublished law, expected a "
                    "FRICTION statement",
                    name,
                )


@dataclass(frozen=True)
class GeneralConstraint(Numbered):
    """Expression that stays zero; the reaction is reported on marker `i`."""

    i: int | None = ident_or_none("I")
    function: Function = expression("FUNCTION")
    others = ("ROUTINE",)


@dataclass(frozen=True)
class Motion(Numbered):
    """Prescribed motion of a joint, or of one component between two markers.

    `order`: of the prescribed derivative: 0, 1 or 2. `start`: initial displacement and velocity, in the dataset's
    units; None if not given.
    """

    joint: int | None = ident_or_none("JOINT")
    i: int | None = ident_or_none("I")
    j: int | None = ident_or_none("J")
    component: str | None = one_of_or_none(*COMPONENTS)
    sort: str | None = one_of_or_none(ROTATIONAL, TRANSLATIONAL)
    order: int = read_by(lambda found, _: ORDERS.index(found.one_of(*ORDERS) or ORDERS[0]), *ORDERS)
    start: tuple[float | None, float | None] = read_by(
        lambda found, _: (found.number("ICDISP"), found.number("ICVEL")), "ICDISP", "ICVEL"
    )
    function: Function = expression("FUNCTION")
    others = ("ROUTINE",)

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a motion without a joint and without two markers and a component."""
        if "JOINT" not in found and not ("I" in found and "J" in found and found.one_of(*COMPONENTS)):
            raise found.fault(f"found no JOINT, expected JOINT, or I and J with one of {', '.join(COMPONENTS)}")


def _scales(found: Arguments, _: Units) -> tuple[float, ...]:
    """Return the scales of a coupler; a missing first one is 1."""
    joints = found.idents("JOINTS", 2, 3)
    scales = found.numbers("SCALES", len(joints) - 1, len(joints))
    if not joints or scales is None:
        raise found.fault("found no JOINTS or no SCALES, expected two or three joints and their scales")
    return (*(1.0,) * (len(joints) - len(scales)), *scales)


def _sorts(found: Arguments, _: Units) -> tuple[str | None, ...]:
    count, text = len(found.idents("JOINTS", 2, 3)), found.text("TYPE") or ""
    letters = [letter.strip().upper() for letter in text.split(":") if letter.strip()]
    sorts = [sort for letter in letters for sort in (ROTATIONAL, TRANSLATIONAL) if sort.startswith(letter)]
    if len(sorts) != len(letters) or (sorts and len(sorts) != count):
        raise found.fault(f"found TYPE = {found.text('TYPE')}, expected T or R for every joint", "TYPE")
    return tuple(sorts) or (None,) * count


@dataclass(frozen=True)
class Coupler(Numbered):
    """Linear equation: the sum of scales times joint displacements is zero; the scales are those of the dataset."""

    joints: tuple[int, ...] = read_by(lambda found, _: found.idents("JOINTS", 2, 3), "JOINTS")
    scales: tuple[float, ...] = read_by(_scales, "SCALES")
    sorts: tuple[str | None, ...] = read_by(_sorts, "TYPE")
    others = ("FUNCTION", "ROUTINE")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a subroutine."""
        if "FUNCTION" in found:
            raise found.fault("found FUNCTION, a user subroutine, expected SCALES", "FUNCTION")


def _geared(found: Arguments, _: Units) -> tuple[int, int]:
    joints = found.idents("JOINTS", 2) or (*found.idents("J1", 1), *found.idents("J2", 1))
    if len(joints) != 2:
        raise found.fault("found no JOINTS, expected the two joints that the gear ties")
    return joints[0], joints[1]


@dataclass(frozen=True)
class Gear(Numbered):
    """Two joints on one carrier whose parts have equal velocity at a marker, along its z axis."""

    joints: tuple[int, int] = read_by(_geared, "JOINTS", "J1", "J2")
    contact: int = ident("CV")
