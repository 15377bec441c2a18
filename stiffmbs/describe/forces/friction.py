"""Dry friction: the friction coefficient as a function of the sliding speed."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ..element import Force, Symbolic
from ..units import si

TINY = 1e-24
"""Offset under the root of a reaction's magnitude, N^2 or N^2 m^2, for a finite derivative at zero."""
AT_REST = 1e-6
"""Offset of a sliding speed in the same way, relative to the smoothed speed."""


def magnitude(*parts: Any, tiny: Any = TINY) -> Any:
    """Return the magnitude of a vector, with a finite derivative at zero."""
    from sympy import sqrt

    return sqrt(sum(part**2 for part in parts) + tiny)


class Friction(Force):
    """Base of forces with dry friction: Coulomb's law with the Stribeck effect, smoothed at zero speed.

    mu(v) = (mu_d + (mu_s - mu_d) exp(-(v/v_stribeck)^2)) tanh(v/v_smooth). There is no true stiction: below v_smooth
    friction is viscous, and a sticking contact creeps.

    Andersson, Soderberg, Bjorklund, Friction models for sliding dry, boundary and mixed lubricated contacts, Tribology
    International 40 (2007) 580-587.
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
        """Return mu / speed, finite at rest, for a sliding velocity of several components."""
        speed = e.named(magnitude(*sliding, tiny=(AT_REST * e.smooth_velocity) ** 2))
        return cls.coefficient(e, speed) / speed

    @staticmethod
    def coefficient(e: Symbolic, v: Any) -> Any:
        """Return mu at a sliding speed, with the sign of the speed."""
        from sympy import exp, tanh

        peak = e.static_friction - e.friction if e.static_friction is not None else 0
        return (e.friction + peak * exp(-((v / e.stribeck_velocity) ** 2))) * tanh(v / e.smooth_velocity)
