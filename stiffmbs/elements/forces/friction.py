"""Dry friction: the friction coefficient as a function of the sliding speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from pydantic import Field

from ...frozen_dataclass import dataclass
from ...reading.units import si
from ..element import Expr, Force, Symbolic, sp

TINY = 1e-24
"""Offset under the root of the magnitude of a vector, N^2 or N^2 m^2, for a finite derivative at zero."""
AT_REST = 1e-6
"""Offset of a sliding speed in the same way, relative to the smoothed speed."""


def length(*parts: Expr, tiny: Expr = TINY) -> Expr:
    """Return the length of a vector, with a finite derivative at zero."""
    return sp.sqrt(sum(part**2 for part in parts) + tiny)


def magnitude(e: Symbolic, *parts: Expr) -> Expr:
    """Return the magnitude of a load and record its breakpoint at zero.

    A vector has a kink where all components are zero. One that passes close to zero changes its direction within a short time: a step that
    ends where a component is zero resolves both.
    """
    if len(parts) == 1:
        return sp.Abs(parts[0])
    e.breakpoints.extend(part for part in map(e.read, parts) if part not in e.breakpoints)
    return length(*parts)


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


@dataclass(frozen=True)
class Loads:
    """Magnitudes of a joint's reaction on the body of marker i, with the force at i's point.

    Attributes
    ----------
    across, thrust : Expr
        Force normal to the axis of the joint's coordinate (z of j in space) and along it, N.
    bending, torsion : Expr
        Moment normal to the axis and about it, N m.
    """

    across: Expr = 0
    thrust: Expr = 0
    bending: Expr = 0
    torsion: Expr = 0
