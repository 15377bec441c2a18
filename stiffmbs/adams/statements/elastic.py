"""Springs, bushings, fields and beams.  MSC Adams/Solver, SPRINGDAMPER, BUSHING, FIELD and BEAM statements."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from ..functions.function import read_function
from .arguments import Arguments
from .constraints import ROTATIONAL, TRANSLATIONAL, Numbered
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
    return SpringDamper(
        found.ident(), statement.line, statement.alias, "SPRINGDAMPER", found.required("I"), found.required("J"), sort,
        k, c, length, preload,
    )  # fmt: skip


def read_bushing(statement: Statement, units: Units) -> Elastic:
    """Read a bushing: a field with diagonal matrices."""
    found = Arguments(statement, "BUSHING", ("I", "J", "K", "KT", "C", "CT", "FORCE", "TORQUE"))
    stiffness, damping, preload = (
        [value for name in pair for value in found.numbers(name, 3) or (0.0,) * 3]
        for pair in (("K", "KT"), ("C", "CT"), ("FORCE", "TORQUE"))
    )
    of_force = _six(units)
    return Elastic(
        found.ident(), statement.line, statement.alias, "BUSHING", found.required("I"), found.required("J"),
        _in_si(_diagonal(stiffness), units, 0), _in_si(_diagonal(damping), units, 1), (0.0,) * 6,
        tuple(value * unit for value, unit in zip(preload, of_force, strict=True)),
    )  # fmt: skip


def read_field(statement: Statement, units: Units) -> Elastic:
    """Read a linear field: full matrices, stored by columns."""
    names = ("I", "J", "KMATRIX", "CMATRIX", "CRATIO", "LENGTH", "FORCE", "FUNCTION", "ROUTINE")
    found = Arguments(statement, "FIELD", names, ("FUNCTION",))
    read_function(found, "FUNCTION")  # refuses a user subroutine
    stiffness = _columns(found.numbers("KMATRIX", 36) or (0.0,) * 36)
    ratio = found.number("CRATIO")
    damping = [[part * ratio for part in row] for row in stiffness] if ratio else None
    damping = damping or _columns(found.numbers("CMATRIX", 36) or (0.0,) * 36)
    lengths = (*(units.length,) * 3, 1.0, 1.0, 1.0)
    return Elastic(
        found.ident(), statement.line, statement.alias, "FIELD", found.required("I"), found.required("J"),
        _in_si(stiffness, units, 0), _in_si(damping, units, 1), _scaled(found, "LENGTH", lengths),
        _scaled(found, "FORCE", _six(units)),
    )  # fmt: skip


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
    for name in (*(name for name, _ in _SECTION), "EMODULUS", "GMODULUS"):
        if not (found.number(name) or 0.0) > 0:
            raise found.fault(f"found no {name}, expected a number above zero", found.line(name))
    length, area, ixx, iyy, izz = ((found.number(name) or 0.0) * units.length**power for name, power in _SECTION)
    young, shear = ((found.number(name) or 0.0) * units.of(force=1, length=-2) for name in ("EMODULUS", "GMODULUS"))
    matrix = found.numbers("CMATRIX", 21)
    damping = (found.number("CRATIO") or 0.0) * units.time
    return Beam(
        found.ident(), statement.line, statement.alias, "BEAM", found.required("I"), found.required("J"), length, area,
        ixx, iyy, izz, young, shear, (found.number("ASY") or 0.0, found.number("ASZ") or 0.0),
        _in_si(_from_half(matrix), units, 1) if matrix else damping,
    )  # fmt: skip


def _six(units: Units) -> Six:
    """Return the units of three forces and three torques."""
    return (*(units.force,) * 3, *(units.of(force=1, length=1),) * 3)


def _scaled(found: Arguments, name: str, factors: Six) -> Six:
    values = found.numbers(name, 6) or (0.0,) * 6
    return tuple(value * factor for value, factor in zip(values, factors, strict=True))


def _diagonal(values: list[float]) -> list[list[float]]:
    return [[value if k == row else 0.0 for k in range(6)] for row, value in enumerate(values)]


def _columns(values: tuple[float, ...]) -> list[list[float]]:
    return [[values[6 * column + row] for column in range(6)] for row in range(6)]


def _from_half(values: tuple[float, ...]) -> list[list[float]]:
    """Return a symmetric matrix from its lower triangle stored by columns."""
    matrix = [[0.0] * 6 for _ in range(6)]
    places = [(row, column) for column in range(6) for row in range(column, 6)]
    for (row, column), value in zip(places, values, strict=True):
        matrix[row][column] = matrix[column][row] = value
    return matrix


def _in_si(matrix: list[list[float]], units: Units, time: int) -> Matrix:
    """Return a stiffness matrix (or damping, with one power of time) in SI units."""
    lengths = (*(units.length,) * 3, 1.0, 1.0, 1.0)
    rows = _six(units)
    return tuple(
        tuple(part * row / length * units.time**time for part, length in zip(parts, lengths, strict=True))
        for parts, row in zip(matrix, rows, strict=True)
    )
