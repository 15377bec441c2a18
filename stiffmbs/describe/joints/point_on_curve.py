"""Point on a smooth curve: a curved slot, or a cam with a pointed follower."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from ..element import Joint, Symbolic
from ..exactly_one import exactly_one
from ..formula_field import Formula, FormulaOf
from ..formula_value import formula_value
from ..marker import Marker
from ..table import Table

TURN = 2 * math.pi
CLOSED = 1e-4
"""Jump of the radius, or of its slope, over its size, from which a cam counts as open; tells it from rounding."""


class PointOnCurve(Joint):
    """Point-follower: the point of marker i stays on a curve fixed to marker j.

    In the axes of marker j the point is at (x, y), or at the distance rho in the direction theta.  The curve is a slot
    ``y`` = Y(x), with y - Y(x) = 0, or a cam ``radius`` = R(theta), with rho - R(theta) = 0.  R repeats after a full
    turn, so that it does not matter where theta jumps from pi to -pi; a formula sees theta between these two.
    Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), section 4.2.6.

    The curve should have no corners.  The reaction is across the curve, without friction, and may pull: the point
    cannot lift off.
    """

    kind: ClassVar[str] = "point_on_curve"
    equations: ClassVar[tuple[str, ...]] = ("normal",)

    type: Literal["point_on_curve"] = "point_on_curve"
    i: Marker = Field(description="marker of the body with the point, on which the reaction is reported")
    j: Marker = Field(description="marker in whose axes the curve is given")
    y: Annotated[Formula | Table, FormulaOf(("x",), time=False, table=True)] | None = Field(
        None, description="Y(x), m: a formula of x or a table"
    )
    radius: Annotated[Formula | Table, FormulaOf(("angle",), time=False, table=True)] | None = Field(
        None, description="R(theta), m: a formula of angle, or a periodic table from any angle to one turn on"
    )

    @field_validator("radius")
    @classmethod
    def _closed(cls, radius: Formula | Table | None) -> Formula | Table | None:
        match radius:
            case Table(ends="periodic", table=((first, _), *_, (last, _))) if abs(last - first - TURN) <= 1e-9 * TURN:
                return radius
            case Table(ends=ends, table=((first, _), *_, (last, _))):
                raise ValueError(
                    f"found a table with {ends} ends over {last - first:.9g} rad, expected a periodic one over a full "
                    f"turn, {TURN:.9g} rad"
                )
            case Formula():
                _refuse_open(radius)
        return radius

    @model_validator(mode="after")
    def _one_curve(self) -> PointOnCurve:
        exactly_one(("y", self.y), ("radius", self.radius))
        return self

    @staticmethod
    def position(e: Symbolic) -> Any:
        d = e.i.point - e.j.point
        x, y = d.dot(e.j.axis), d.dot(e.j.normal)
        if e.y is not None:
            return [y - e.y(x)]
        from sympy import atan2

        return [e.distance(e.i.point, e.j.point) - e.radius(atan2(y, x))]


def _refuse_open(radius: Formula) -> None:
    """Refuse a formula of the polar angle that does not meet itself, with its slope, after a full turn."""
    step = 1e-6
    before, end, start, after = (
        formula_value(radius, angle=angle) for angle in (math.pi - step, math.pi, -math.pi, step - math.pi)
    )
    size = max(abs(start), abs(end))
    jump, kink = abs(end - start), abs((end - before) - (after - start)) / step
    if jump > CLOSED * size or kink > CLOSED * size:
        raise ValueError(
            f"found '{radius.text}', which is {start:.6g} at angle -pi and {end:.6g} at pi"
            f"{', with different slopes' if jump <= CLOSED * size else ''}, expected a curve that closes smoothly"
        )
