"""Springs, bushings, fields and beams.  MSC Adams/Solver, SPRINGDAMPER, BUSHING, FIELD and BEAM statements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..functions.function import read_function
from .arguments import Arguments, Numbered
from .constraints import ROTATIONAL, TRANSLATIONAL
from .text import Statement
from .units import Units

Six = tuple[float, ...]
Matrix = tuple[Six, ...]


@dataclass(frozen=True)
class SpringDamper(Numbered):
    """Linear spring and damper between two markers, in SI units."""

    i: int
    j: int
    sort: str
    stiffness: float
    damping: float
    length: float
    preload: float


@dataclass(frozen=True)
class Elastic(Numbered):
    """Bushing or field: six force components between two markers, in the axes of the second; in SI units.

    force = preload - stiffness (displacement - length) - damping velocity; the matrices have six rows.
    """

    i: int
    j: int
    stiffness: Matrix
    damping: Matrix
    length: Six
    preload: Six

    @property
    def has_potential(self) -> bool:
        """True if both matrices are symmetric up to rounding."""
        pairs = [(m[i][j], m[j][i]) for m in (self.stiffness, self.damping) for i, j in combinations(range(6), 2)]
        return all(abs(a - b) <= 1e-12 * max(abs(a), abs(b)) for a, b in pairs)


@dataclass(frozen=True)
class Beam(Numbered):
    """Massless beam along the x axis of marker j, from j to i; in SI units.

    Attributes
    ----------
    area, torsion, iyy, izz : float
        Cross section: area, m^2; torsion constant and second moments, m^4.
    shear : tuple of float
        Shear area ratios ASY and ASZ; 0 neglects shear.
    damping : float or Matrix
        Ratio to the stiffness, s; or a matrix of six rows.
    """

    i: int
    j: int
    length: float
    area: float
    torsion: float
    iyy: float
    izz: float
    young: float
    shear_modulus: float
    shear: tuple[float, float]
    damping: float | Matrix


def read_spring_damper(statement: Statement, units: Units) -> SpringDamper:
    """Read a linear spring and damper."""
    linear, turning = ("K", "C", "LENGTH", "FORCE"), ("KT", "CT", "ANGLE", "TORQUE")
    found = Arguments(statement, "SPRINGDAMPER", (TRANSLATIONAL, ROTATIONAL, "I", "J", *linear, *turning))
    sort = found.one_of(TRANSLATIONAL, ROTATIONAL)
    if sort is None:
        raise found.fault("found no kind of spring, expected TRANSLATIONAL or ROTATIONAL")
    names, others = (linear, turning) if sort == TRANSLATIONAL else (turning, linear)
    invalid_placement = [name for name in others if name in found]
    if invalid_placement:
        raise found.fault(f"found {invalid_placement[0]} with {sort}, expected only {', '.join(names)}")
    arm = 0 if sort == TRANSLATIONAL else 1
    dimensions = (
        units.of(force=1, length=2 * arm - 1), units.of(force=1, length=2 * arm - 1, time=1),
        1.0 if arm else units.length, units.of(force=1, length=arm),
    )  # fmt: skip
    values = ((found.number(name) or 0.0) * unit for name, unit in zip(names, dimensions, strict=True))
    k, c, length, preload = values
    return SpringDamper(*found.head(), found.required("I"), found.required("J"), sort, k, c, length, preload)


def read_bushing(statement: Statement, units: Units) -> Elastic:
    """Read a bushing: a field with diagonal matrices."""
    found = Arguments(statement, "BUSHING", ("I", "J", "K", "KT", "C", "CT", "FORCE", "TORQUE"))
    stiffness, damping, preload = (
        [value for name in pair for value in found.numbers(name, 3) or (0.0,) * 3]
        for pair in (("K", "KT"), ("C", "CT"), ("FORCE", "TORQUE"))
    )
    return Elastic(
        *found.head(), found.required("I"), found.required("J"), _in_si(np.diag(stiffness), units, 0),
        _in_si(np.diag(damping), units, 1), (0.0,) * 6, _scaled(preload, _forces(units)),
    )  # fmt: skip


def read_field(statement: Statement, units: Units) -> Elastic:
    """Read a linear field: full matrices, stored by columns."""
    names = ("I", "J", "KMATRIX", "CMATRIX", "CRATIO", "LENGTH", "FORCE", "FUNCTION", "ROUTINE")
    found = Arguments(statement, "FIELD", names, ("FUNCTION",))
    read_function(found, "FUNCTION")  # refuses a user subroutine
    stiffness, ratio = _columns(found, "KMATRIX"), found.number("CRATIO")
    damping = stiffness * ratio if ratio else _columns(found, "CMATRIX")
    return Elastic(
        *found.head(), found.required("I"), found.required("J"), _in_si(stiffness, units, 0), _in_si(damping, units, 1),
        _scaled(found.numbers("LENGTH", 6), _lengths(units)), _scaled(found.numbers("FORCE", 6), _forces(units)),
    )  # fmt: skip


def _columns(found: Arguments, name: str) -> np.ndarray:
    return np.reshape(found.numbers(name, 36) or (0.0,) * 36, (6, 6)).T


_SECTION = (("LENGTH", 1), ("AREA", 2), ("IXX", 4), ("IYY", 4), ("IZZ", 4))


def read_beam(statement: Statement, units: Units) -> Beam:
    """Read a beam with uniform cross section."""
    names = ("I", "J", *(name for name, _ in _SECTION), "ASY", "ASZ", "EMODULUS", "GMODULUS", "CMATRIX", "CRATIO")
    found = Arguments(statement, "BEAM", (*names, "FORMULATION"))
    if (found.text("FORMULATION") or "LINEAR").upper() != "LINEAR":
        raise found.fault(
            f"found FORMULATION = {found.text('FORMULATION')}, expected LINEAR: the laws of the others are not published; several linear beams in a row bend as far",
            found.line("FORMULATION"),
        )
    length, area, ixx, iyy, izz = (found.needed(name) * units.length**power for name, power in _SECTION)
    young, shear = (found.needed(name) * units.of(force=1, length=-2) for name in ("EMODULUS", "GMODULUS"))
    half, damping = np.zeros((6, 6)), (found.number("CRATIO") or 0.0) * units.time
    if matrix := found.numbers("CMATRIX", 21):  # lower triangle by columns, which are rows of the upper one
        half[np.triu_indices(6)] = matrix
    return Beam(
        *found.head(), found.required("I"), found.required("J"), length, area,
        ixx, iyy, izz, young, shear, (found.number("ASY") or 0.0, found.number("ASZ") or 0.0),
        _in_si(half + np.triu(half, 1).T, units, 1) if matrix else damping,
    )  # fmt: skip


def _forces(units: Units) -> np.ndarray:
    """Return the units of three forces and three torques."""
    return np.repeat([units.force, units.of(force=1, length=1)], 3)


def _lengths(units: Units) -> np.ndarray:
    return np.repeat([units.length, 1.0], 3)


def _scaled(values: Sequence[float] | None, factors: np.ndarray) -> Six:
    return tuple((np.array(values) * factors).tolist()) if values else (0.0,) * 6


def _in_si(matrix: np.ndarray, units: Units, time: int) -> Matrix:
    """Return a stiffness matrix (or damping, with one power of time) in SI units."""
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = matrix * _forces(units)[:, None] / _lengths(units) * units.time**time
    return tuple(map(tuple, scaled.tolist()))
