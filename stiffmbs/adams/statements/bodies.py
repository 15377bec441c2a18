"""Parts, point masses and markers.  MSC Adams/Solver, PART, POINT_MASS and MARKER statements."""

from __future__ import annotations

from dataclasses import dataclass

from ...reading.marker import GROUND
from .arguments import Arguments, Numbered
from .geometry import Frame, read_frame
from .text import Statement
from .units import Units

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Part(Numbered):
    """Rigid body, point mass or ground, in SI units.

    Attributes
    ----------
    frame : Frame
        The part's axes at the start, in ground axes.
    center : int or None
        Centre-of-mass marker.
    moments : tuple of float
        Ixx, Iyy, Izz and the products Ixy, Ixz, Iyz (positive integrals) in the axes of the inertia marker, about its
        origin.
    velocity : tuple of float or None
        Velocity of the centre of mass, in the axes of `velocity_marker` or ground; None if not given.
    omega : tuple of float or None
        Angular velocity in the axes of `omega_marker`, or of the centre-of-mass marker.
    exact : bool
        True if assembly must not move some of its coordinates.
    """

    frame: Frame
    ground: bool = False
    mass: float = 0.0
    center: int | None = None
    inertia_marker: int | None = None
    moments: tuple[float, ...] = (0.0,) * 6
    velocity: Vector | None = None
    velocity_marker: int | None = None
    omega: Vector | None = None
    omega_marker: int | None = None
    exact: bool = False

    @property
    def point(self) -> bool:
        """True for a point mass."""
        return self.keyword == "POINT_MASS"

    @property
    def name(self) -> str:
        return GROUND if self.ground else super().name


@dataclass(frozen=True)
class Marker(Numbered):
    """Point and axes on a part, given by keyword and number; in SI units, in the part's axes."""

    owner: tuple[str, int]
    frame: Frame
    floating: bool = False


_FRAME = ("QG", "REULER", "XG", "ZG")
_PART = (
    "GROUND", "MASS", "CM", "IM", "IP", *_FRAME, "MATERIAL", "VX", "VY", "VZ", "VM", "WX", "WY", "WZ", "WM", "EXACT",
)  # fmt: skip


def read_part(statement: Statement, units: Units) -> Part:
    """Read a part; its mass is checked once all markers are known. Raises DatasetFault."""
    found = Arguments(statement, "PART", _PART)
    frame = read_frame(found, "QG", "XG", "ZG", units.length)
    moments = found.numbers("IP", 3, 6) or (0.0,) * 6
    of_inertia = units.of(mass=1, length=2)
    return Part(
        *found.head(), frame, ground="GROUND" in found,
        mass=(found.number("MASS") or 0.0) * units.mass, center=found.reference("CM"),
        inertia_marker=found.reference("IM"),
        moments=tuple(moment * of_inertia for moment in (*moments, *(0.0,) * (6 - len(moments)))),
        velocity=_rates(found, ("VX", "VY", "VZ"), units.of(length=1, time=-1)),
        velocity_marker=found.reference("VM"),
        omega=_rates(found, ("WX", "WY", "WZ"), units.of(time=-1)), omega_marker=found.reference("WM"),
        exact="EXACT" in found,
    )  # fmt: skip


def read_point_mass(statement: Statement, units: Units) -> Part:
    """Read a point mass: a part that does not rotate."""
    found = Arguments(statement, "POINT_MASS", ("MASS", "CM", *_FRAME, "VX", "VY", "VZ", "EXACT"))
    return Part(
        *found.head(), read_frame(found, "QG", "XG", "ZG", units.length),
        mass=(found.number("MASS") or 0.0) * units.mass, center=found.reference("CM"),
        velocity=_rates(found, ("VX", "VY", "VZ"), units.of(length=1, time=-1)), exact="EXACT" in found,
    )  # fmt: skip


def _rates(found: Arguments, names: tuple[str, str, str], unit: float) -> Vector | None:
    if not any(name in found for name in names):
        return None
    x, y, z = ((found.number(name) or 0.0) * unit for name in names)
    return x, y, z


def read_marker(statement: Statement, units: Units, before: Part | None = None) -> Marker:
    """Read a marker, fixed or floating, on a part or a point mass; by default on the part `before`."""
    names = ("PART", "POINT_MASS", "QP", "REULER", "XP", "ZP", "USEXP", "FLOATING")
    found = Arguments(statement, "MARKER", names)
    owner = found.one_of("PART", "POINT_MASS")
    if owner is not None:
        carrier = owner, found.required(owner)
    elif before is not None:
        carrier = before.keyword, before.ident
    else:
        raise found.fault("found neither PART nor POINT_MASS, expected the part that carries the marker")
    frame = read_frame(found, "QP", "XP", "ZP", units.length)
    return Marker(*found.head(), carrier, frame, "FLOATING" in found)
