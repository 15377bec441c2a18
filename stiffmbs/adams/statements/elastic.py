"""Springs, bushings, fields and beams.  MSC Adams/Solver, SPRINGDAMPER, BUSHING, FIELD and BEAM statements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..functions.function import read_function
from .arguments import Arguments
from .constraints import ROTATIONAL, TRANSLATIONAL
from .declared import Numbered, above_zero, constant, ident, number, one_of, read_by
from .units import Units

Six = tuple[float, ...]
Matrix = tuple[Six, ...]
LINEAR, TURNING = ("K", "C", "LENGTH", "FORCE"), ("KT", "CT", "ANGLE", "TORQUE")


def _of_sort(k: int, force: int, length: int, time: int = 0) -> float:
    """Declare a number of a linear spring, or its counterpart for rotation: one arm for each force and length."""

    def read(found: Arguments, units: Units) -> float:
        if TRANSLATIONAL in found:
            return (found.number(LINEAR[k]) or 0.0) * units.of(force=force, length=length, time=time)
        return (found.number(TURNING[k]) or 0.0) * units.of(force=force, length=force, time=time)

    return read_by(read, LINEAR[k], TURNING[k])


@dataclass(frozen=True)
class SpringDamper(Numbered):
    """Linear spring and damper between two markers, in SI units."""

    sort: str = one_of(
        TRANSLATIONAL, ROTATIONAL, missing="found no kind of spring, expected TRANSLATIONAL or ROTATIONAL"
    )
    i: int = ident("I")
    j: int = ident("J")
    stiffness: float = _of_sort(0, force=1, length=-1)
    damping: float = _of_sort(1, force=1, length=-1, time=1)
    length: float = _of_sort(2, force=0, length=1)
    preload: float = _of_sort(3, force=1, length=0)

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse numbers of the other sort."""
        sort = found.one_of(TRANSLATIONAL, ROTATIONAL)
        names, others = (LINEAR, TURNING) if sort == TRANSLATIONAL else (TURNING, LINEAR)
        for name in others:
            if sort and name in found:
                raise found.fault(f"found {name} with {sort}, expected only {', '.join(names)}")


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


@dataclass(frozen=True)
class Elastic(Numbered):
    """Bushing or field: six force components between two markers, in the axes of the second; in SI units.

    force = preload - stiffness (displacement - length) - damping velocity; the matrices have six rows.
    """

    stiffness: Matrix
    damping: Matrix
    length: Six
    preload: Six
    i: int = ident("I")
    j: int = ident("J")

    @property
    def has_potential(self) -> bool:
        """True if both matrices are symmetric up to rounding."""
        pairs = [(m[i][j], m[j][i]) for m in (self.stiffness, self.damping) for i, j in combinations(range(6), 2)]
        return all(abs(a - b) <= 1e-12 * max(abs(a), abs(b)) for a, b in pairs)


def _threes(found: Arguments, *names: str) -> list[float]:
    return [value for name in names for value in found.numbers(name, 3) or (0.0,) * 3]


@dataclass(frozen=True)
class Bushing(Elastic):
    """Field with diagonal matrices."""

    stiffness: Matrix = read_by(lambda found, units: _in_si(np.diag(_threes(found, "K", "KT")), units, 0), "K", "KT")
    damping: Matrix = read_by(lambda found, units: _in_si(np.diag(_threes(found, "C", "CT")), units, 1), "C", "CT")
    length: Six = constant((0.0,) * 6)
    preload: Six = read_by(
        lambda found, units: _scaled(_threes(found, "FORCE", "TORQUE"), _forces(units)), "FORCE", "TORQUE"
    )


def _columns(found: Arguments, name: str) -> np.ndarray:
    return np.reshape(found.numbers(name, 36) or (0.0,) * 36, (6, 6)).T


def _field_damping(found: Arguments, units: Units) -> Matrix:
    ratio = found.number("CRATIO")
    return _in_si(_columns(found, "KMATRIX") * ratio if ratio else _columns(found, "CMATRIX"), units, 1)


@dataclass(frozen=True)
class Field(Elastic):
    """Linear field: full matrices, stored by columns."""

    stiffness: Matrix = read_by(lambda found, units: _in_si(_columns(found, "KMATRIX"), units, 0), "KMATRIX")
    damping: Matrix = read_by(_field_damping, "CMATRIX", "CRATIO")
    length: Six = read_by(lambda found, units: _scaled(found.numbers("LENGTH", 6), _lengths(units)), "LENGTH")
    preload: Six = read_by(lambda found, units: _scaled(found.numbers("FORCE", 6), _forces(units)), "FORCE")
    others = ("FUNCTION", "ROUTINE")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a user's subroutine."""
        read_function(found, "FUNCTION")


def _beam_damping(found: Arguments, units: Units) -> float | Matrix:
    half = np.zeros((6, 6))
    if matrix := found.numbers("CMATRIX", 21):  # lower triangle by columns, which are rows of the upper one
        half[np.triu_indices(6)] = matrix
        return _in_si(half + np.triu(half, 1).T, units, 1)
    return (found.number("CRATIO") or 0.0) * units.time


@dataclass(frozen=True)
class Beam(Numbered):
    """Massless beam along the x axis of marker j, from j to i; in SI units.

    `torsion`: torsion constant. `asy`, `asz`: shear area ratios; 0 neglects shear. `damping`: ratio to the stiffness,
    s; or a matrix of six rows.
    """

    i: int = ident("I")
    j: int = ident("J")
    length: float = above_zero("LENGTH", length=1)
    area: float = above_zero("AREA", length=2)
    torsion: float = above_zero("IXX", length=4)
    iyy: float = above_zero("IYY", length=4)
    izz: float = above_zero("IZZ", length=4)
    asy: float = number("ASY")
    asz: float = number("ASZ")
    young: float = above_zero("EMODULUS", force=1, length=-2)
    shear_modulus: float = above_zero("GMODULUS", force=1, length=-2)
    damping: float | Matrix = read_by(_beam_damping, "CMATRIX", "CRATIO")
    others = ("FORMULATION",)

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse nonlinear formulations."""
        if (found.text("FORMULATION") or "LINEAR").upper() != "LINEAR":
            raise found.fault(
                f"found FORMULATION = {found.text('FORMULATION')}, expected LINEAR: the laws of the others are not "
                "published; for large deflections use several linear beams in series",
                "FORMULATION",
            )
