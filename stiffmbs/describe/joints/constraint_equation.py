"""Constraint by a formula of the user."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..formula.field import OfPosition
from .user_constraint import ONE_OR_MORE, UserConstraint


class ConstraintEquation(UserConstraint):
    """Formulas of body coordinates and time that remain zero: ``cart.y - 0.1*sin(cart.x)``.

    The equations are named ``zero[0] zero[1] ...`` in reports. The reaction is reported on the body of marker `i`,
    about its point. Without `i` it is reported on the first body that the formulas name, about its centre of mass.

    This is Adams' GCON of positions.
    """

    kind: ClassVar[str] = "equation"
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = ({"zero": "a.x"},)
    reflected: ClassVar[dict[str, str] | None] = {}

    zero: Annotated[tuple[OfPosition, ...], ONE_OR_MORE] = Field(
        min_length=1, description="a formula, or several, that the joint keeps at zero"
    )

    @staticmethod
    def position(e: Symbolic) -> Any:
        return e.zero
