"""A smooth curve in the axes of a marker: a curved slot, or a cam."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, field_validator, model_validator

from ..element import Joint
from ..exactly_one import exactly_one
from ..formula.field import Formula, FormulaOf
from ..formula.value import formula_value
from ..marker import MarkerReference
from ..table import Table

M = TypeVar("M", bound=MarkerReference)
TURN = 2 * math.pi
CLOSED = 1e-9
"""Change of the radius in a full turn, over the radius, from which a cam counts as open; tells it from rounding."""


class Curve(Joint, Generic[M]):
    """Base of the points on curves of the plane and of space (it has no kind: scenes name its subclasses)."""

    equations: ClassVar[tuple[str, ...]] = ("normal",)

    type: Literal["point_on_curve"] = "point_on_curve"
    i: M = Field(description="marker of the body with the point, on which the reaction is reported")
    j: M = Field(description="marker in whose axes the curve is given")
    y: Annotated[Formula | Table, FormulaOf(("x",), ("length",), "length", time=False, table=True)] | None = Field(
        None, description="Y(x), m: a formula of x or a table"
    )
    radius: Annotated[Formula | Table, FormulaOf(("angle",), ("angle",), "length", time=False, table=True)] | None = (
        Field(
            None, description="R(theta), m: a formula of sin(angle) and cos(angle), or a periodic table over one turn"
        )
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
    def _one_curve(self) -> Self:
        exactly_one(("y", self.y), ("radius", self.radius))
        return self


def _refuse_open(radius: Formula) -> None:
    """Refuse a formula of the polar angle that is another one turn on, or two turns back."""
    for angle in np.linspace(-TURN, TURN, 50):
        here = formula_value(radius, angle=angle)
        for turns in (-2, 1):
            there = formula_value(radius, angle=angle + turns * TURN)
            if abs(there - here) > CLOSED * abs(here):
                raise ValueError(
                    f"found '{radius.text}', which is {here:.6g} at angle {angle:.6g} and {there:.6g} at "
                    f"{angle + turns * TURN:.6g}, expected a formula that repeats every turn (of sin(angle) and "
                    "cos(angle)), or a periodic table"
                )
