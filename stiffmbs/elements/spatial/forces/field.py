"""Field: linear force and torque of six components, each depending on all six deformations (Adams: FIELD)."""

from __future__ import annotations

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Symbolic
from ...forces.elastic_matrix import stored
from ..elastic import NO_ROW, Connection, Preload, pull_back


class FieldForce(Connection):
    """Linear elastic connection of two separate markers: preload - K (s - s0) - C (v, w).

    s is the position of marker i in the axes of j and its rotation vector relative to them, s0 its value without force.
    Its action and its behaviour at large rotations are those of the `bushing`; it has an offset and no curves.

    MSC Adams/Solver, FIELD statement, whose small angles equal the rotation vector to first order.
    """

    kind = "field"
    forms = (
        {"stiffness": ..., "damping": ...},
        {"stiffness": ((1,) * 6,) * 6, "damping": ((1,) * 6,) * 6, "free": (1, 0, 0, 0, 0, 0)},
    )
    reflected = {"stiffness": "matrix", "damping": "matrix", "preload": "components", "free": "components"}

    preload: Preload = Field(NO_ROW, description="force and torque on i at s0, N and N m")
    free: tuple[si.Length, si.Length, si.Length, si.Angle, si.Angle, si.Angle] | None = Field(
        None, description="s0: position and rotation vector of i relative to j without force, m and rad"
    )

    @staticmethod
    def strain(e: Symbolic) -> list[Expr]:
        """Return s - s0."""
        free = e.free if e.free is not None else (0,) * 6
        return [x - x0 for x, x0 in zip(FieldForce.deformation(e), free, strict=True)]

    @classmethod
    def elastic(cls, e: Symbolic) -> list[Expr]:
        """Return preload - K (s - s0)."""
        return pull_back(e.stiffness, cls.strain(e), e.preload)

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        return stored(e.stiffness, FieldForce.strain(e), e.preload)
