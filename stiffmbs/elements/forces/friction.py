"""Dry friction: the friction coefficient as a function of the sliding speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from pydantic import Field

from ...reading.units import si
from ..element import Expr, Force, Symbolic, sp
from ..loads import length

AT_REST = 1e-6
"""Offset under the root of a sliding speed, relative to the smoothed speed (compare `stiffmbs.elements.loads.TINY`)."""


class Friction(Force):
    """Base of forces with dry friction: Coulomb's law with the Stribeck effect, smoothed at zero speed.

    mu(v) = (mu_d + (mu_s - mu_d) exp(-(v/v_d)^2)) tanh(v/v_s), with the stiction velocity v_s and the friction velocity
    v_d. There is no true stiction: friction is viscous below v_s, so that a contact under load keeps sliding slowly.

    Andersson, Soderberg, Bjorklund, Friction models for sliding dry, boundary and mixed lubricated contacts, Tribology
    International 40 (2007) 580-587.
    """

    written_as: ClassVar[Mapping[str, str]] = {
        "smooth_velocity": "its new name 'stiction_velocity'",
        "stribeck_velocity": "its new name 'friction_velocity'",
    }

    friction: si.NumberOrZero | None = Field(None, description="mu_d, dynamic coefficient of friction")
    static_friction: si.NumberOrZero | None = Field(None, description="mu_s, static coefficient; by default mu_d")
    friction_velocity: si.PositiveVelocity = Field(
        0.01, description="v_d, scale of the sliding speeds over which mu_s falls to mu_d, m/s"
    )
    stiction_velocity: si.PositiveVelocity = Field(
        1e-4, description="v_s, scale of the sliding speeds below which friction is viscous, m/s"
    )

    @classmethod
    def per_speed(cls, e: Symbolic, *sliding: Expr) -> Expr:
        """Return mu / speed, finite at rest, for a sliding velocity of several components."""
        speed = e.named(length(*sliding, tiny=(AT_REST * e.stiction_velocity) ** 2))
        return cls.coefficient(e, speed) / speed

    @staticmethod
    def coefficient(e: Symbolic, v: Expr) -> Expr:
        """Return mu at a sliding speed, with the sign of the speed."""
        peak = e.static_friction - e.friction if e.static_friction is not None else 0
        return (e.friction + peak * sp.exp(-((v / e.friction_velocity) ** 2))) * sp.tanh(v / e.stiction_velocity)
