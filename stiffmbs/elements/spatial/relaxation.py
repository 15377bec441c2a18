"""Transient slips of a tyre by relaxation lengths.

The deflections x and y of the contact patch satisfy x' = -Vsx - abs(Vx) x/sigma_x and y' = Vy - abs(Vx) y/sigma_y. The
sliding velocity is Vsx = Vx - Re Omega along the wheel's heading and Vy across it. The slips are x/sigma_x and
atan(y/sigma_y): a first-order lag of the steady state at speed, and a spring at rest. Pacejka, Tire and Vehicle
Dynamics (2006), sec. 8.5 and 8.6.
"""

from __future__ import annotations

from ..element import Expr, Symbolic, sp
from ..roads.road import above_zero, magnitude
from .contact_point import ContactPoint

DEFLECTIONS = ("deflection_x", "deflection_y")
"""States of a tyre with relaxation lengths, m."""
LEAST_RELAXATION_LENGTH = 0.01
"""Smallest relaxation length, m; otherwise it would be zero at lift-off."""
RENEWED = 2
"""Decay of the deflections of a sliding wheel at rest, per relaxation length, which limits its slips to 1/2. Otherwise
the deflection of a locked wheel would grow without bound."""
DAMPING = 0.02
"""Damping time of a tyre at rest, s, for the damping of the tread rubber; it vanishes at the speed `slow`."""


def lagged(
    e: Symbolic, contact: ContactPoint, sliding: Expr, lengths: tuple[Expr, Expr]
) -> tuple[Expr, Expr, tuple[Expr, Expr]]:
    """Return slip, tangent of the slip angle, and state rates of a tyre whose own states are the deflections.

    `sliding`: vsx, m/s. `lengths`: longitudinal and lateral relaxation length, m.
    """
    least = sp.Float(str(LEAST_RELAXATION_LENGTH))
    along, across = (e.named(least + above_zero(e.named(length - least))) for length in lengths)
    x, y = e.own
    forward = magnitude(contact.vx)
    standing = e.named(above_zero(e.named(1 - forward / e.slow)) ** 2)
    speed = e.named(forward + RENEWED * standing * magnitude(sliding, contact.vy))
    damping = e.named(sp.Float(str(DAMPING)) * standing)
    return (
        e.named((x - damping * sliding) / along),
        e.named((y + damping * contact.vy) / across),
        (-sliding - speed * x / along, contact.vy - speed * y / across),
    )
