"""Bushing: stiffness and damping in two directions and in rotation."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import Field, WithJsonSchema, field_validator

from ...reading.formula.field import ForceOfDeflection, TorqueOfDeflection
from ...reading.marker import Marker
from ...reading.units import si
from ..element import Expr, Force, Symbolic
from ..turns import WithinHalfATurn
from .elastic_matrix import REFLECTED, C, Cc, Ct, K, Kc, Kt, check_symmetric, from_diagonal, stored_with_laws, times

_AS_WRITTEN = WithJsonSchema({"type": "array", "minItems": 3, "maxItems": 3})
Stiffness = Annotated[tuple[tuple[K, K, Kc], tuple[K, K, Kc], tuple[Kc, Kc, Kt]], _AS_WRITTEN]
Damping = Annotated[tuple[tuple[C, C, Cc], tuple[C, C, Cc], tuple[Cc, Cc, Ct]], _AS_WRITTEN]
"""Symmetric 3 x 3 matrix; None for uncoupled directions, for which nothing is computed."""

NONE: Final = (0.0, 0.0, 0.0)


class Bushing(WithinHalfATurn, Force):
    """Elastic force and torque between two markers.

    The deformation s = (x, y, angle) of marker i relative to marker j is measured along the axes of j. The angle counts
    revolutions; it starts within half a turn, as at a joint in place of the bushing. The force and the
    torque on i are preload - K s - C s' - law(s), conjugate to the three deformations: a positive angle gives a negative
    torque on i. The force acts on i at its point, and the opposite
    force acts on j at the same point of space, so linear and angular momentum are conserved.

    With ``axes: ground`` x and y are the ground axes, and the force acts at each body's own marker. Angular momentum is
    then conserved only if the force is along the line between the two points.

    Stiffness and damping are three numbers (x, y, angle), or a symmetric matrix that couples the directions. A law that
    is a table or a polynomial in s has a potential. With any other formula the element has none, and energy.total is
    not conserved.

    The equations are the planar form of the BUSHING and FIELD statements of Adams.
    """

    kind = "bushing"
    forms = ({"stiffness": ..., "damping": ...}, {"stiffness": ..., "damping": ..., "axes": "ground"})
    reflected = {**REFLECTED, "law_x": "x", "law_y": "y", "law_angle": "angle"}

    i: Marker = Field(description="marker of the first body, on which force and torque are reported")
    j: Marker = Field(description="marker of the second body, whose direction orients the bushing")
    stiffness: Stiffness = Field(NONE, validate_default=True, description="K: x, y, angle, or a symmetric matrix")
    damping: Damping = Field(NONE, validate_default=True, description="C: x, y, angle, or a symmetric matrix")
    preload: tuple[si.Force, si.Force, si.Torque] = Field(
        NONE, description="force and torque on i without deformation, N, N, N m"
    )
    law_x: ForceOfDeflection | None = Field(None, description="force against the deformation in x added over s (m), N")
    law_y: ForceOfDeflection | None = Field(None, description="force against the deformation in y added over s (m), N")
    law_angle: TorqueOfDeflection | None = Field(
        None, description="moment against the rotation added over s (rad), N m"
    )
    axes: Literal["j", "ground"] = Field("j", description="axes x and y: marker j's or the ground's")

    _symmetric = field_validator("stiffness", "damping")(check_symmetric)

    @field_validator("stiffness", "damping", mode="before")
    @classmethod
    def _rows(cls, found: object) -> object:
        if isinstance(found, list | tuple) and len(found) != 3:
            raise ValueError(f"found {len(found)} entries, expected 3, or 3 rows of a symmetric matrix")
        return from_diagonal(found)

    @staticmethod
    def deformation(e: Symbolic) -> tuple[Expr, Expr, Expr]:
        """Return x, y and angle of marker i relative to marker j."""
        d = e.i.point - e.j.point
        x, y = d if e.axes == "ground" else (d.dot(e.j.axis), d.dot(e.j.normal))
        return x, y, e.i.angle - e.j.angle

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return preload - K s - C s' - law(s) for each deformation."""
        s = Bushing.deformation(e)
        elastic, viscous = times(e.stiffness, s), times(e.damping, [e.rate(part) for part in s])
        laws = [law(part) if law is not None else 0 for law, part in zip(_laws(e), s, strict=True)]
        return [(e.preload[k] - elastic[k] - viscous[k] - laws[k], s[k]) for k in range(3)]

    @classmethod
    def condensed_powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        return cls.powers(e)

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        return stored_with_laws(e, Bushing.deformation(e), _laws(e))


def _laws(e: Symbolic) -> tuple[Expr, Expr, Expr]:
    return e.law_x, e.law_y, e.law_angle
