"""Massless elastic beam between two markers (Adams: BEAM)."""

from __future__ import annotations

from pydantic import Field, field_validator, model_validator

from ....reading.units import si
from ...element import Expr, Matrix, Symbolic
from ...forces.elastic_matrix import check_symmetric, stored
from ..elastic import NO_MATRIX, NO_ROW, Damping, Elastic, pull_back, six_rows, without_zeros


class Beam(Elastic):
    """Massless straight beam of uniform cross section along the x axis of marker j, from j to i.

    Without load i is at (length, 0, 0) in the axes of j, with parallel axes. The deformation s relative to this pose
    consists of displacement and rotation vector. The force of Timoshenko's linear theory is -K s - C (v, w), in j's
    axes; it acts as for the `bushing`. Only the deformation must be small; for large deflections use a chain of several
    beams.

    With P = 12 E Izz asy/(G A L^2) for bending in the plane of x and y, and 12 E Iyy asz/(G A L^2) in that of x and z::

        K11 = E A/L    K22 = 12 E Izz/(L^3 (1 + P))    K26 = -6 E Izz/(L^2 (1 + P))    K66 = (4 + P) E Izz/(L (1 + P))
        K44 = G Ixx/L  K33 = 12 E Iyy/(L^3 (1 + P))    K35 =  6 E Iyy/(L^2 (1 + P))    K55 = (4 + P) E Iyy/(L (1 + P))

    MSC Adams/Solver, BEAM statement (linear); Przemieniecki, Theory of Matrix Structural Analysis (1968), sec. 5.6.
    """

    kind = "beam"

    length: si.PositiveLength = Field(description="L, without load, m")
    young: si.PositivePressure = Field(description="E, modulus of elasticity, N/m^2")
    shear_modulus: si.PositivePressure = Field(description="G, N/m^2")
    area: si.PositiveArea = Field(description="A, area of the cross section, m^2")
    torsion: si.PositiveSecondMoment = Field(description="Ixx, torsion constant of the cross section, m^4")
    iyy: si.PositiveSecondMoment = Field(description="second moment of area about y, m^4")
    izz: si.PositiveSecondMoment = Field(description="second moment of area about z, m^4")
    asy: si.NumberOrZero = Field(0.0, description="shear area ratio in y, such as 6/5 for a rectangle; 0: no shear")
    asz: si.NumberOrZero = Field(0.0, description="shear area ratio in z")
    damping_ratio: si.TimeOrZero | None = Field(None, description="C over K, s")
    damping: Damping = Field(
        NO_MATRIX, description="C, in place of a ratio: six numbers, two 3x3 matrices or a 6x6 matrix"
    )

    _six_rows = field_validator("damping", mode="before")(six_rows)
    _symmetric = field_validator("damping")(check_symmetric)
    _sparse = field_validator("damping")(without_zeros)

    @model_validator(mode="after")
    def _one_damping(self) -> Beam:
        if self.damping_ratio is not None and self.damping != NO_MATRIX:
            raise ValueError("found both 'damping' and 'damping_ratio', expected one of them")
        return self

    @staticmethod
    def stiffness(e: Symbolic) -> Matrix:
        """Return K, six rows."""
        E, G, A, L = e.young, e.shear_modulus, e.area, e.length
        along, twist = E * A / L, G * e.torsion / L
        y, yc, c = _bending(E * e.izz, L, 12 * E * e.izz * e.asy / (G * A * L**2))
        z, zb, b = _bending(E * e.iyy, L, 12 * E * e.iyy * e.asz / (G * A * L**2))
        o = None
        return (
            (along, o, o, o, o, o), (o, y, o, o, o, -yc), (o, o, z, o, zb, o),
            (o, o, o, twist, o, o), (o, o, zb, o, b, o), (o, -yc, o, o, o, c),
        )  # fmt: skip

    @staticmethod
    def strain(e: Symbolic) -> list[Expr]:
        """Return the displacement and rotation of marker i from its unloaded pose."""
        along, *others = Beam.deformation(e)
        return [along - e.length, *others]

    @classmethod
    def elastic(cls, e: Symbolic) -> list[Expr]:
        """Return -K s."""
        return pull_back(cls.stiffness(e), cls.strain(e), NO_ROW)

    @classmethod
    def viscosity(cls, e: Symbolic) -> Matrix:
        if e.damping_ratio is None:
            return e.damping
        return [[part if part is None else e.damping_ratio * part for part in row] for row in cls.stiffness(e)]

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        return stored(Beam.stiffness(e), Beam.strain(e), NO_ROW)


def _bending(rigidity: Expr, length: Expr, shear: Expr) -> tuple[Expr, Expr, Expr]:
    """Return force over deflection, force over angle, and moment over angle at a beam's end."""
    stiff = rigidity / (1 + shear)
    return 12 * stiff / length**3, 6 * stiff / length**2, (4 + shear) * stiff / length
