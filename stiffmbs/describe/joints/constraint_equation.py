"""A constraint given by the user as a formula."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field, field_validator

from ..element import Joint, Symbolic
from ..formula_field import OfPosition


class ConstraintEquation(Joint):
    """Formulas of body coordinates and time that stay zero: ``cart.y - 0.1*sin(cart.x)``.

    The reaction is reported on the first body that the formulas name, about its centre of mass.
    """

    kind: ClassVar[str] = "equation"

    type: Literal["equation"] = "equation"
    zero: tuple[OfPosition, ...] = Field(min_length=1, description="formulas that the joint keeps at zero")

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
