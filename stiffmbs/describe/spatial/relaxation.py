"""Slips that follow the motion of a wheel by relaxation lengths, as the contact patch of a tyre is deflected on the way.

With the sliding velocity Vsx = Vx - Re Omega and Vy along and across the wheel's heading, the deflections x and y of the patch
have x' = -Vsx - Vx x/sigma_x and y' = Vy - Vx y/sigma_y, and the slips are x/sigma_x and atan(y/sigma_y): at speed those of the
steady state with a lag of the first order, at rest a spring.  Pacejka, Tire and Vehicle Dynamics (2006), sec. 8.5 and 8.6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..element import Symbolic
from ..roads.road import above_zero, magnitude
from .contact_point import ContactPoint

DEFLECTIONS = ("deflection_x", "deflection_y")
"""The states of a tyre with relaxation lengths, m."""
LEAST_RELAXATION_LENGTH = 0.01
"""m, the least relaxation length: where a wheel lifts off they would be zero."""
RENEWED = 2
"""Where a wheel slides at a standstill its patch is renewed each 1/2 relaxation length, so that slips there end at 1/2; by
rolling alone a blocked wheel would be deflected ever further."""
DAMPING = 0.02
"""s, by which a tyre at rest is a damper beside a spring, as the tread's rubber is; its part is gone at the speed `slow`."""


@dataclass(frozen=True)
class Lagged:
    """Slip, tangent of the slip angle, and the rates of the deflections."""

    slip: Any
    tangent: Any
    rates: tuple[Any, Any]


def lagged(e: Symbolic, contact: ContactPoint, sliding: Any, lengths: tuple[Any, Any]) -> Lagged:
    """The slips of a tyre whose own states are the deflections.

    Parameters
    ----------
    sliding : Expr
        Vsx, m/s.
    lengths : tuple of Expr
        Longitudinal and lateral relaxation length, m.
    """
    from sympy import Float, sqrt

    least = Float(str(LEAST_RELAXATION_LENGTH))
    along, across = (e.named(least + above_zero(e.named(length - least))) for length in lengths)
    x, y = e.own
    forward = magnitude(contact.vx)
    standing = e.named(above_zero(e.named(1 - forward / e.slow)) ** 2)
    whole = sqrt(sliding**2 + contact.vy**2 + Float("1e-60"))
    speed = e.named(forward + RENEWED * standing * whole)
    damping = e.named(Float(str(DAMPING)) * standing)
    return Lagged(
        e.named((x - damping * sliding) / along),
        e.named((y + damping * contact.vy) / across),
        (-sliding - speed * x / along, contact.vy - speed * y / across),
    )
