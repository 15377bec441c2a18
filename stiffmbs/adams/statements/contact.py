"""Contacts between primitives, and their graphics.  MSC Adams/Solver, CONTACT and GRAPHICS statements."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

from .arguments import Arguments
from .declared import Numbered, above_zero, number, read_by
from .geometry import ROUNDING
from .text import DatasetFault, Statement
from .units import Units

SPHERE, PLANE, ELLIPSOID, CYLINDER, BOX = "SPHERE", "PLANE", "ELLIPSOID", "CYLINDER", "BOX"
SOLIDS = "SOLID_TO_SOLID"
_SHAPES = (
    "ELLIPSOID", "PLANE", "CYLINDER", "BOX", "FRUSTUM", "TORUS", "CIRCLE", "ARC", "EXTERNAL", "OUTLINE", "FORCE",
    "SPRINGDAMPER", "CURVE",
)  # fmt: skip


@dataclass(frozen=True)
class Friction:
    """Coulomb friction with Adams' smooth transition; velocities in the dataset's units."""

    static: float
    dynamic: float
    stiction_velocity: float
    friction_velocity: float


_FRICTION = ("MU_STATIC", "MU_DYNAMIC", "STICTION_TRANSITION_VELOCITY", "FRICTION_TRANSITION_VELOCITY")


def _friction(found: Arguments, _: Units) -> Friction | None:
    asked = (found.text("COULOMB_FRICTION") or "OFF").strip().upper()
    if asked == "OFF":
        return None
    if asked != "ON":
        raise found.fault(f"found COULOMB_FRICTION = {asked}, expected ON or OFF", "COULOMB_FRICTION")
    static, dynamic, slow, fast = (found.number(name) for name in _FRICTION)
    if static is None or dynamic is None or slow is None or fast is None or not 0 < slow < fast:
        raise found.fault(
            f"found incomplete friction, expected {', '.join(_FRICTION)}, with velocities above zero, the last the larger one"
        )
    return Friction(static, dynamic, slow, fast)


def _pairs(found: Arguments, _: Units) -> tuple[tuple[int, int], ...]:
    sides = found.idents("IGEOM"), found.idents("JGEOM")
    if not all(sides):
        raise found.fault("found no IGEOM or no JGEOM, expected one or more GRAPHICS for each")
    return tuple(itertools.product(*sides))


_NOT_READ = (
    "POISSON", "PENALTY", "RESTITUTION_COEFFICIENT", "NORMAL_FUNCTION", "NORMAL_ROUTINE", "FRICTION_FUNCTION",
    "FRICTION_ROUTINE", "AUGMENTED_LAGRANGIAN_FORMULATION", "IFLIP_GEOMETRY", "JFLIP_GEOMETRY", "IFLIP_NORMAL",
    "JFLIP_NORMAL",
)  # fmt: skip


@dataclass(frozen=True)
class Contact(Numbered):
    """Contact force by Adams' IMPACT function, in the dataset's units.

    `pairs`: GRAPHICS statements of both sides, each of one with each of the other. `part`: number of the only pair
    among several; 0 for the first.
    """

    pairs: tuple[tuple[int, int], ...] = read_by(_pairs, "IGEOM", "JGEOM")
    stiffness: float = above_zero("STIFFNESS")
    damping: float = number("DAMPING")
    exponent: float = above_zero("EXPONENT")
    depth: float = above_zero("DMAX")
    friction: Friction | None = read_by(_friction, "COULOMB_FRICTION", *_FRICTION)
    part: int = 0
    others = ("TYPE", "IMPACT", "NO_FRICTION", "STICTION")
    ignored = dict.fromkeys(
        ("MAX_STICTION_DEFORMATION", "STICTION"), "it slides slowly below STICTION_TRANSITION_VELOCITY"
    )
    refused = dict.fromkeys(_NOT_READ, "a contact by IMPACT between primitives")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse other types of contact."""
        if (kind := (found.text("TYPE") or SOLIDS).strip().upper()) and not SOLIDS.startswith(kind):
            raise found.fault(f"found TYPE = {kind}, expected {SOLIDS}", "TYPE")
        found.without_effect("IMPACT", "NO_FRICTION")
        stiction = found.says("STICTION")
        if stiction not in ("", "ON", "OFF"):
            raise found.fault(
                f"found STICTION = {stiction}, expected ON or OFF; a velocity is STICTION_TRANSITION_VELOCITY",
                "STICTION",
            )
        if stiction == "OFF":
            found.without_effect("STICTION", "MAX_STICTION_DEFORMATION")

    @property
    def name(self) -> str:
        """Name of its force in the scene."""
        return super().name + (f"_{self.part}" if self.part else "")

    def of_pairs(self) -> list[Contact]:
        """Return a contact for each pair of geometries."""
        return [replace(self, pairs=(pair,), part=k + 1 if k else 0) for k, pair in enumerate(self.pairs)]


@dataclass(frozen=True)
class Shape:
    """Solid at a marker, or the xy plane of a marker, in the dataset's units.

    `marker`: centre of a sphere or an ellipsoid, centre of one end of a cylinder about z, or a corner of a box.
    `sizes`: sphere: radius; ellipsoid: semi-axes; cylinder: radius and length along z; box: edge lengths.
    """

    sort: str
    marker: int
    sizes: tuple[float, ...] = ()


_SIZES: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    ELLIPSOID: ("CM", ("XSCALE", "YSCALE", "ZSCALE"), ("SEG",)),
    PLANE: ("RM", (), ("XMINIMUM", "XMAXIMUM", "YMINIMUM", "YMAXIMUM")),
    CYLINDER: ("CM", ("RADIUS", "LENGTH"), ("SIDES", "SEG")),
    BOX: ("CORNER", ("X", "Y", "Z"), ()),
}
"""Marker argument, size arguments and display-only arguments of each shape."""


def read_shape(statement: Statement) -> Shape:
    """Return the solid or the plane of a GRAPHICS statement. Raises DatasetFault if it is of another kind."""
    words = [piece.text.strip().upper() for piece in statement.pieces]
    sort = next((full for word in words for full in _SHAPES if len(word) > 2 and full.startswith(word)), "no kind")
    if sort not in _SIZES:
        raise DatasetFault(
            statement.line, f"GRAPHICS/{statement.ident}", f"found {sort} in a CONTACT, expected {', '.join(_SIZES)}"
        )
    at, names, drawn = _SIZES[sort]
    found = Arguments(statement, "GRAPHICS", (sort, at, *names, *drawn))
    sizes = tuple(found.number(name) or 0.0 for name in names)
    for name, size in zip(names, sizes, strict=True):
        if size == 0 or (size < 0 and sort != BOX and name != "LENGTH"):
            raise found.fault(f"found no {name}, expected a number above zero", name)
    if sort == ELLIPSOID:
        sizes = tuple(size / 2 for size in sizes)
        if max(sizes) - min(sizes) <= ROUNDING * max(sizes):
            return Shape(SPHERE, found.required(at), sizes[:1])
    return Shape(sort, found.required(at), sizes)
