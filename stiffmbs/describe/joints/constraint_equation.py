"""A constraint given by the user as a formula."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, WithJsonSchema, field_validator

from ..element import Joint, Symbolic
from ..formula_field import OfPosition

_FORMULA = {"type": "string", "description": "a formula of coordinates and t"}
ONE_OR_MORE = WithJsonSchema({"anyOf": [_FORMULA, {"type": "array", "items": _FORMULA, "minItems": 1}]})


class ConstraintEquation(Joint):
    """Formulas of body coordinates and time that stay zero: ``cart.y - 0.1*sin(cart.x)``.

    The reaction is reported on the first body that the formulas name, about its centre of mass.
    """

    kind: ClassVar[str] = "equation"

    type: Literal["equation"] = "equation"
    zero: Annotated[tuple[OfPosition, ...], ONE_OR_MORE] = Field(
        min_length=1, description="a formula, or several, that the joint keeps at zero"
    )

    @field_validator("zero", mode="before")
    @classmethod
    def _one_or_more(cls, found: Any) -> Any:
        return tuple(found) if isinstance(found, list | tuple) else (found,)

    @field_validator("zero")
    @classmethod
    def _names_a_body(cls, zero: tuple[OfPosition, ...]) -> tuple[OfPosition, ...]:
        for formula in zero:
            if not any(True for _ in formula.bodies()):
                raise ValueError(f"found '{formula.text}', expected a formula with a body's coordinate such as cart.x")
        return zero

    @staticmethod
    def position(e: Symbolic) -> Any:
        return e.zero

    @staticmethod
    def point(e: Symbolic) -> Any:
        return e.frames[0].origin

    def equation_names(self) -> tuple[str, ...]:
        return tuple(f"zero[{k}]" for k in range(len(self.zero)))
