"""Velocity constraint by a formula of the user."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field, field_validator

from ...reading.formula.field import OfMotion
from ...reading.formula.formula import Formula
from ...reading.formula.names import VELOCITIES
from ...reading.joint_name import ORDERS
from ..element import Expr, Symbolic
from .constraint_equation import ONE_OR_MORE, UserConstraint


class VelocityEquation(UserConstraint):
    """Formulas linear in velocities that remain zero, J(q) u - b(q, t) = 0, also nonholonomic ones.

    Examples are a knife edge, ``sled.vy*cos(sled.angle) - sled.vx*sin(sled.angle)``, and a rolling disc. Positions are
    free and start as described; the velocities are made consistent with the equations at the start. The equations are
    named ``zero[0] zero[1] ...`` in reports.

    The reaction, -J^T lam, is reported on the body of marker `i`, about its point. Without `i` it is reported on the
    first body that the formulas name, about its centre of mass.

    Neimark, Fufaev, Dynamics of Nonholonomic Systems (1972), chapter III.
    """

    kind = "velocity_equation"
    forms = ({"zero": "a.vy"},)
    reflected = {}

    zero: Annotated[tuple[OfMotion, ...], ONE_OR_MORE] = Field(
        min_length=1, description="a formula, or several, linear in velocities, that the joint keeps at zero"
    )

    @field_validator("zero")
    @classmethod
    def _names_a_velocity(cls, zero: tuple[Formula, ...]) -> tuple[Formula, ...]:
        for formula in zero:
            used = {*(name for _, name in formula.coordinates()), *(name for name, _ in formula.measures())}
            if not (used & set(VELOCITIES) or any(name.endswith(ORDERS[1]) for name in used)):
                raise ValueError(f"found '{formula.text}', expected a formula with a velocity such as cart.vx")
        return zero

    @staticmethod
    def velocity(e: Symbolic) -> Sequence[Expr]:
        return e.zero
