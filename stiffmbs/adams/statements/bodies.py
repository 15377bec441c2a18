"""Parts, point masses and markers.  MSC Adams/Solver, PART, POINT_MASS and MARKER statements."""

from __future__ import annotations

from dataclasses import dataclass

from ...reading.marker import GROUND
from .arguments import Arguments
from .declared import Numbered, constant, given, ident_or_none, number, read_by
from .geometry import Frame, read_frame
from .units import Units

Vector = tuple[float, float, float]
ASSEMBLY = {"EXACT": "assembly may move any part"}


def _frame(origin: str, x_point: str, z_point: str, *words: str) -> Frame:
    names = (origin, "REULER", x_point, z_point, *words)
    return read_by(lambda found, units: read_frame(found, origin, x_point, z_point, units.length), *names)


def _moments(found: Arguments, units: Units) -> tuple[float, ...]:
    moments = found.numbers("IP", 3, 6) or (0.0,) * 6
    unit = units.of(mass=1, length=2)
    return tuple(moment * unit for moment in (*moments, *(0.0,) * (6 - len(moments))))


def _rates(letter: str, **powers: float) -> Vector | None:
    """Declare three components of a velocity; None if none is given."""
    names = tuple(f"{letter}{axis}" for axis in "XYZ")

    def read(found: Arguments, units: Units) -> Vector | None:
        if not any(name in found for name in names):
            return None
        x, y, z = ((found.number(name) or 0.0) * units.of(**powers) for name in names)
        return x, y, z

    return read_by(read, *names)


@dataclass(frozen=True)
class Part(Numbered):
    """Rigid body or ground, in SI units; its mass is checked once all markers are known."""

    ground: bool = given("GROUND")
    mass: float = number("MASS", mass=1)
    center: int | None = ident_or_none("CM")
    inertia_marker: int | None = ident_or_none("IM")
    # Ixx, Iyy, Izz and the products Ixy, Ixz, Iyz (positive integrals) in the axes of the inertia marker, about its origin
    moments: tuple[float, ...] = read_by(_moments, "IP")
    frame: Frame = _frame("QG", "XG", "ZG")  # axes at the start, in ground axes
    # of the centre of mass, in the axes of `velocity_marker` or ground
    velocity: Vector | None = _rates("V", length=1, time=-1)
    velocity_marker: int | None = ident_or_none("VM")
    # angular velocity in the axes of `omega_marker`, or of the centre-of-mass marker
    omega: Vector | None = _rates("W", time=-1)
    omega_marker: int | None = ident_or_none("WM")
    exact: bool = given("EXACT")
    ignored = {"MATERIAL": "masses are given", **ASSEMBLY}

    @property
    def point(self) -> bool:
        """True for a point mass."""
        return self.keyword == "POINT_MASS"

    @property
    def name(self) -> str:
        """Name of the body in the scene; the ground has a fixed one."""
        return GROUND if self.ground else super().name


@dataclass(frozen=True)
class PointMass(Part):
    """Part that does not rotate."""

    ground: bool = constant(False)
    inertia_marker: int | None = constant(None)
    moments: tuple[float, ...] = constant((0.0,) * 6)
    velocity_marker: int | None = constant(None)
    omega: Vector | None = constant(None)
    omega_marker: int | None = constant(None)
    ignored = ASSEMBLY


def _owner(found: Arguments, _: Units) -> tuple[str, int]:
    owner = found.one_of("PART", "POINT_MASS")
    return (owner, found.required(owner)) if owner else ("", 0)


@dataclass(frozen=True)
class Marker(Numbered):
    """Point and axes, in SI units, in the axes of the part `owner` (keyword and number; empty for the preceding part)."""

    owner: tuple[str, int] = read_by(_owner, "PART", "POINT_MASS")
    frame: Frame = _frame("QP", "XP", "ZP", "USEXP")
    floating: bool = given("FLOATING")
