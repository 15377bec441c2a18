"""Point on a smooth curve in the axes of a marker: a curved slot, or a cam with a point follower."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Generic, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from ...reading.fields import exactly_one
from ...reading.formula.field import FormulaOf
from ...reading.formula.formula import Formula
from ...reading.formula.value import formula_value
from ...reading.marker import M, Marker
from ...reading.table import Table
from ..element import Expr, Joint, Symbolic, sp
from ..turns import TURN, KeepsDescribedTurns
from .planar_pair import PlanarPair

CLOSED = 1e-9
"""Tolerance of the change over a full turn, relative to the largest radius, for a closed cam."""


SLOT = {"table": [[0, 0], [1, 0.1], [2, 0]]}
CAM = {"table": [[0, 0.1], [3, 0.2], [TURN, 0.1]], "ends": "periodic"}
"""Samples of curves."""
OfX = Annotated[Formula | Table, FormulaOf(("x",), ("length",), "length", time=False, table=True)]
OfAngle = Annotated[Formula | Table, FormulaOf(("angle",), ("angle",), "length", time=False, table=True)]
"""Length as a formula or a table of x, m, or of a polar angle, rad."""


class Curve(Joint, Generic[M]):
    """Base of the planar and the spatial point on a curve."""

    kind = "point_on_curve"
    equations: ClassVar[tuple[str, ...]] = ("normal",)
    further_coordinates: ClassVar[tuple[str, ...]] = ("displacement_x", "displacement_y")
    forms: ClassVar[tuple[Mapping[str, object], ...]] = ({"y": SLOT}, {"radius": CAM})

    i: M = Field(description="marker of the body with the point, on which the reaction is reported")
    j: M = Field(description="marker in whose axes the curve is given")
    y: OfX | None = Field(None, description="Y(x), m: a formula of x or a table")
    radius: OfAngle | None = Field(
        None, description="R(theta), m: a formula of sin(angle) and cos(angle), or a periodic table over one turn"
    )

    @field_validator("radius")
    @classmethod
    def _closed(cls, radius: Formula | Table | None) -> Formula | Table | None:
        return repeating(radius)

    @staticmethod
    def displacement_x(e: Symbolic) -> Expr:
        """Return x of the point in the axes of marker j."""
        return (e.i.point - e.j.point).dot(e.j.axes[0])

    @staticmethod
    def displacement_y(e: Symbolic) -> Expr:
        """Return y of the point in the axes of marker j."""
        return (e.i.point - e.j.point).dot(e.j.axes[1])

    @model_validator(mode="after")
    def _one_curve(self) -> Self:
        exactly_one(("y", self.y), ("radius", self.radius))
        return self


class PointOnCurve(KeepsDescribedTurns, Curve[Marker]):
    """Point follower: the point of marker i remains on a curve fixed to marker j.

    In the axes of marker j the point is at (x, y), or at the distance rho in the direction theta (-pi .. pi). The curve
    is a slot ``y`` = Y(x), with y - Y(x) = 0, or a cam ``radius`` = R(theta), with rho - R(theta) = 0. R must be
    periodic over a turn, so the jump of the arctangent and the number of turns have no effect. Nikravesh,
    Computer-Aided Analysis of Mechanical Systems (1988), section 4.2.6.

    The curve should be free of breakpoints. The reaction is normal to the curve, without friction, and bilateral: the
    point cannot lift off.
    """

    further_coordinates = ("displacement_x", "displacement_y", "angle")
    angle: ClassVar = staticmethod(PlanarPair.angle)

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        """Return y - Y(x) of a slot, rho - R(theta) of a cam, in the axes of marker j."""
        d = e.i.point - e.j.point
        if e.y is not None:
            return [d.dot(e.j.normal) - e.y(d.dot(e.j.axis))]
        return [e.distance(e.i.point, e.j.point) - e.radius(sp.atan2(d.dot(e.j.normal), d.dot(e.j.axis)))]


def repeating(law: Formula | Table | None) -> Formula | Table | None:
    """Return a law of the polar angle that is periodic over a turn. Raises ValueError if it is not periodic."""
    match law:
        case Table(repeats=True, table=((first, _), *_, (last, _))) if abs(last - first - TURN) <= 1e-9 * TURN:
            return law
        case Table(ends=ends, table=((first, _), *_, (last, _))):
            raise ValueError(
                f"found a table with {ends or 'natural'} ends over {last - first:.9g} rad, expected a periodic one over a full "
                f"turn, {TURN:.9g} rad"
            )
        case Formula():
            _refuse_open(law)
    return law


def _refuse_open(law: Formula) -> None:
    """Refuse a formula of the polar angle that differs after one turn, or two turns back."""
    angles = np.linspace(-TURN, TURN, 50)
    values = [formula_value(law, angle=angle) for angle in angles]
    size = max(map(abs, values))
    for angle, here in zip(angles, values, strict=True):
        for turns in (-2, 1):
            there = formula_value(law, angle=angle + turns * TURN)
            if abs(there - here) > CLOSED * size:
                raise ValueError(
                    f"found '{law.text}', which is {here:.6g} at angle {angle:.6g} and {there:.6g} at "
                    f"{angle + turns * TURN:.6g}, expected a formula that repeats every turn (of sin(angle) and "
                    "cos(angle)), or a periodic table"
                )
