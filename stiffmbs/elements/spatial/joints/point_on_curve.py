"""Point on a smooth curve in space: a curved slot or wire, or a cam with a point follower."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from pydantic import Field, field_validator, model_validator

from ....reading.formula.formula import Formula
from ....reading.table import Table
from ...element import Expr, Symbolic, sp
from ...joints.point_on_curve import CAM, SLOT, Curve, OfAngle, OfX, repeating
from ..marker import Marker
from ..primitives import IN_PLANE, along


class PointOnCurve(Curve[Marker]):
    """Point follower: the point of marker i remains on a curve in the axes of marker j, in any orientation.

    In the axes of marker j the point is at (x, y), or at the distance rho in the direction theta from x. A slot ``y`` =
    Y(x) has y - Y(x) = 0, a cam ``radius`` = R(theta) has rho - R(theta) = 0, with R periodic over a turn. Nikravesh,
    Computer-Aided Analysis of Mechanical Systems (1988), section 4.2.6.

    By default the curve is in the xy plane. A slot can leave it by ``z`` = Z(x), as a bent wire, and a cam by
    ``height`` = H(theta), which must be periodic, too.

    The curve should be free of breakpoints. The reaction is normal to the curve, without friction, and bilateral: the
    point cannot lift off. This is Adams' PTCV.
    """

    equations = (*Curve.equations, *IN_PLANE.rows)
    forms = (*Curve.forms, {"y": SLOT, "z": SLOT}, {"radius": CAM, "height": CAM})

    z: OfX | None = Field(None, description="Z(x), m, of a slot: a formula of x or a table; by default in the plane")
    height: OfAngle | None = Field(None, description="H(theta), m, of a cam: as its radius; by default in the plane")

    @field_validator("height")
    @classmethod
    def _closed_in_height(cls, height: Formula | Table | None) -> Formula | Table | None:
        return repeating(height)

    @model_validator(mode="after")
    def _of_one_kind(self) -> Self:
        if self.z is not None and self.y is None:
            raise ValueError("found z for a curve given by its radius, expected z only with y")
        if self.height is not None and self.radius is None:
            raise ValueError("found height for a slot, expected height only with a radius")
        return self

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        """Return y - Y(x) of a slot or rho - R(theta) of a cam, and the residual along z."""
        x, y, z = e.named([along(e.i, e.j, axis) for axis in (e.j.x, e.j.y, e.j.z)])
        if e.y is not None:
            return [y - e.y(x), z if e.z is None else z - e.z(x)]
        angle = e.named(sp.atan2(y, x))
        return [sp.sqrt(x**2 + y**2) - e.radius(angle), z if e.height is None else z - e.height(angle)]
