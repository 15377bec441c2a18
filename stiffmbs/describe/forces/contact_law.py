"""The law by which surfaces in contact repel each other, shared by the contacts of the plane and of space."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from ..element import Symbolic
from ..fields import Measured
from .friction import Friction


class ContactLaw(Friction):
    """Base of contacts (it has no kind: scenes name its subclasses).

    Where the gap is closed by delta = -gap > 0 the surfaces repel each other with N = k delta^n (1 + chi delta'), never
    below zero.  Without friction and dissipation this has the potential k delta^(n+1)/(n+1).
    """

    stiffness: Annotated[float, Measured("value", above=0)] = Field(description="k, N/m^n")
    exponent: Annotated[float, Measured("number", at_least=1)] = Field(1.5, description="n; 1.5 for Hertz's contact")
    dissipation: Annotated[float, Measured("value", at_least=0)] = Field(0.0, description="chi, s/m")

    @model_validator(mode="after")
    def _rubs(self) -> ContactLaw:
        if self.static_friction is not None and self.friction is None:
            raise ValueError("found static_friction alone, expected friction too")
        return self

    @staticmethod
    def gap(e: Symbolic) -> Any:
        """Distance of the surfaces, m; below zero where they overlap."""
        raise NotImplementedError

    @staticmethod
    def gap_round(e: Symbolic, outward: int) -> Any:
        """Distance of what is about i from a round surface about j, which is solid inside (`outward` 1) or outside (-1)."""
        return outward * (e.distance(e.i.point, e.j.point) - e.surface_radius) - e.radius

    @classmethod
    def pressure(cls, e: Symbolic) -> Any:
        """The normal force N, zero without contact."""
        from sympy import And, Piecewise

        gap = e.named(cls.gap(e))
        damped = e.named(1 - e.dissipation * e.rate(gap))
        return Piecewise((e.stiffness * (-gap) ** e.exponent * damped, And(gap < 0, damped > 0)), (0, True))

    @classmethod
    def potential(cls, e: Symbolic) -> Any:
        from sympy import Piecewise

        gap, power = cls.gap(e), e.exponent + 1
        return Piecewise((e.stiffness * (-gap) ** power / power, gap < 0), (0, True))

    @classmethod
    def event_functions(cls, e: Symbolic) -> Any:
        """Above zero where the surfaces push: dissipation may end the push while they still overlap."""
        from sympy import Min

        gap = e.named(cls.gap(e))
        return (Min(-gap, 1 - e.dissipation * e.rate(gap)),)
