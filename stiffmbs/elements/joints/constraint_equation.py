"""Constraint by a formula of the user."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field, WithJsonSchema, field_validator

from ...reading.formula.field import OfPosition
from ...reading.formula.formula import Formula
from ...reading.marker import MarkerReference
from ..element import Expr, Joint, Matrix, Symbolic

_FORMULA = {"type": "string", "description": "a formula of coordinates and t"}
ONE_OR_MORE = WithJsonSchema({"anyOf": [_FORMULA, {"type": "array", "items": _FORMULA, "minItems": 1}]})


class UserConstraint(Joint):
    """Base of the constraints whose field `zero` contains formulas; scenes use its subclasses.

    The equations are named ``zero[0] zero[1] ...`` in reports. The reaction is reported on the body of marker `i`,
    about its point. Without `i` it is reported on the first body that the formulas name, about its centre of mass.
    """

    i: MarkerReference | None = Field(None, description="marker of the body on which the reaction is reported")
    j: MarkerReference | None = Field(None, description="marker for requests of the reaction")
    zero: tuple[Formula, ...]

    @field_validator("zero", mode="before")
    @classmethod
    def _one_or_more(cls, found: object) -> object:
        return tuple(found) if isinstance(found, list | tuple) else (found,)

    @field_validator("zero")
    @classmethod
    def _names_a_body(cls, zero: tuple[Formula, ...]) -> tuple[Formula, ...]:
        for formula in zero:
            if not any(True for _ in formula.bodies()):
                raise ValueError(f"found '{formula.text}', expected a formula with a body's coordinate such as cart.x")
        return zero

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        return e.frames[0].origin if e.i is None else e.i.point

    def equation_names(self) -> tuple[str, ...]:
        return tuple(f"zero[{k}]" for k in range(len(self.zero)))


class ConstraintEquation(UserConstraint):
    """Formulas of body coordinates and time that remain zero: ``cart.y - 0.1*sin(cart.x)``.

    The equations are named ``zero[0] zero[1] ...`` in reports. The reaction is reported on the body of marker `i`,
    about its point. Without `i` it is reported on the first body that the formulas name, about its centre of mass.

    This is Adams' GCON of positions.
    """

    kind = "equation"
    forms = ({"zero": "a.x"},)
    reflected = {}

    zero: Annotated[tuple[OfPosition, ...], ONE_OR_MORE] = Field(
        min_length=1, description="a formula, or several, that the joint keeps at zero"
    )

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        return e.zero
