"""Spatial bushing: stiffness and damping in three directions and three rotations."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ....reading.formula.field import ForceOfDeflection, TorqueOfDeflection
from ...element import Expr, Matrix, Symbolic, sp
from ...forces.elastic_matrix import REFLECTED, stored_with_laws
from ..elastic import NO_ROW, Connection, Preload, pull_back

Law = ForceOfDeflection | None
Moment = TorqueOfDeflection | None


class Bushing(Connection):
    """Elastic force and torque between two markers in all six components.

    The deformation s = (x, y, z, and the rotation vector) of marker i relative to marker j is measured along the axes
    of j. The elastic force is preload - K s - law(s), conjugate to the six deformations, so energy is conserved at any
    angle. For a rotation about one axis this is the moment about it, up to three quarters of a turn, where the run
    stops. Without stiffness about exactly one axis i can rotate about it without limit, and the stiffness acts on its
    tilt relative to j. Damping is -C times the velocity and angular velocity of i relative to j's body, in j's axes. It
    acts on i at its point, and the opposite on j at the same point of space, so linear and angular momentum are
    conserved.

    With ``axes: ground`` x, y and z are the ground axes, and the force acts at each body's own marker; moments and
    rotations are still along j's axes. Angular momentum is then conserved only if the force is along the line between
    the two points.

    Stiffness and damping are six numbers, two symmetric 3x3 matrices (of forces, of moments), or a symmetric 6x6
    matrix. A law that is a table or a polynomial in s has a potential. With any other formula the element has none, and
    energy.total is not conserved.

    MSC Adams/Solver, BUSHING statement, whose small angles a, b, c equal the rotation vector to first order.
    """

    kind = "bushing"
    forms = ({"stiffness": ..., "damping": ...}, {"stiffness": ..., "damping": ..., "axes": "ground"})
    reflected = {
        **REFLECTED, "law_x": "x", "law_y": "y", "law_z": "z",
        "law_about_x": "about x", "law_about_y": "about y", "law_about_z": "about z",
    }  # fmt: skip

    preload: Preload = Field(NO_ROW, description="force and torque on i without deformation, N and N m")
    law_x: Law = Field(None, description="force against the deformation in x added over s (m), N")
    law_y: Law = Field(None, description="force against the deformation in y added over s (m), N")
    law_z: Law = Field(None, description="force against the deformation in z added over s (m), N")
    law_about_x: Moment = Field(None, description="moment against the rotation about x over s (rad), N m")
    law_about_y: Moment = Field(None, description="moment against the rotation about y over s (rad), N m")
    law_about_z: Moment = Field(None, description="moment against the rotation about z over s (rad), N m")

    axes: Literal["j", "ground"] = Field("j", description="axes x, y and z of the force: marker j's or the ground's")

    @classmethod
    def resisted(cls, e: Symbolic) -> list[bool]:
        laws = (e.law_about_x, e.law_about_y, e.law_about_z)
        return [has or law is not None for has, law in zip(super().resisted(e), laws, strict=True)]

    @classmethod
    def frame(cls, e: Symbolic) -> list[Matrix]:
        return [sp.eye(3)[:, k] for k in range(3)] if e.axes == "ground" else super().frame(e)

    @classmethod
    def drift(cls, e: Symbolic) -> Matrix:
        return e.rate(e.i.point - e.j.point) if e.axes == "ground" else super().drift(e)

    @classmethod
    def elastic(cls, e: Symbolic) -> list[Expr]:
        """Return preload - K s - law(s)."""
        s = cls.deformation(e)
        linear = pull_back(e.stiffness, s, e.preload)
        return [f - (law(x) if law is not None else 0) for f, law, x in zip(linear, _laws(e), s, strict=True)]

    @classmethod
    def potential(cls, e: Symbolic) -> Expr:
        return stored_with_laws(e, cls.deformation(e), _laws(e))


def _laws(e: Symbolic) -> tuple[Expr, ...]:
    return e.law_x, e.law_y, e.law_z, e.law_about_x, e.law_about_y, e.law_about_z
