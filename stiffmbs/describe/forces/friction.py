"""Dry friction: the coefficient over the sliding speed, shared by all forces that rub."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ..element import Force, Symbolic
from ..units import si

TINY = 1e-24
"""N^2 or N^2 m^2, added under the root of a reaction, so that its derivative exists where the reaction vanishes."""
AT_REST = 1e-6
"""Part of the smoothed speed that is added to a sliding speed in the same way."""


def magnitude(*parts: Any, tiny: Any = TINY) -> Any:
    """Of a vector by its components, with a derivative where it vanishes."""
    from sympy import sqrt

    return sqrt(sum(part**2 for part in parts) + tiny)


class Friction(Force):
    """Base of forces with dry friction: Coulomb's law with Stribeck's falling branch, smoothed where sliding turns round.

    mu(v) = (mu_d + (mu_s - mu_d) exp(-(v/v_stribeck)^2)) tanh(v/v_smooth).  Nothing sticks for good: below v_smooth
    friction is viscous, and what should stick creeps.

    Andersson, Soderberg, Bjorklund, Friction models for sliding dry, boundary and mixed lubricated contacts,
    Tribology International 40 (2007) 580-587.
    """

    friction: si.NumberOrZero | None = Field(None, description="mu_d, coefficient of friction when sliding fast")
    static_friction: si.NumberOrZero | None = Field(
        None, description="mu_s, coefficient when sliding begins; mu_d unless given"
    )
    stribeck_velocity: si.PositiveVelocity = Field(0.01, description="sliding speed over which mu_s falls to mu_d, m/s")
    smooth_velocity: si.PositiveVelocity = Field(
        1e-4, description="sliding speed below which friction is smoothed, m/s"
    )

    @classmethod
    def per_speed(cls, e: Symbolic, *sliding: Any) -> Any:
        """mu over the speed, for a sliding velocity of several components: what turns it into the friction, finite at rest."""
        speed = e.named(magnitude(*sliding, tiny=(AT_REST * e.smooth_velocity) ** 2))
        return cls.coefficient(e, speed) / speed

    @staticmethod
    def coefficient(e: Symbolic, v: Any) -> Any:
        """mu at a sliding speed, with its sign."""
        from sympy import exp, tanh

        peak = e.static_friction - e.friction if e.static_friction is not None else 0
        return (e.friction + peak * exp(-((v / e.stribeck_velocity) ** 2))) * tanh(v / e.smooth_velocity)
