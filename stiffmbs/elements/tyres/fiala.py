"""Fiala's formula: forces and torques of steady slip.

The equations accept symbols and numbers: `f` names common subexpressions.

Fiala, Seitenkräfte am rollenden Luftreifen, VDI-Zeitschrift 96 (1954) 973-979; MSC Adams/Tire, Fiala tire model.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Float, Rational, tan

from ..element import Expr, Symbolic
from ..roads.road import above_zero, clipped, magnitude
from .magic_formula import Curve, Forces, Formula, Name, Slip, Torque

TINY = 1e-30
"""Offset of forces in divisors, for a wheel without contact."""
ZERO = Rational(0)


@dataclass(frozen=True)
class Constants:
    """Slip stiffness (N), cornering stiffness (N/rad), friction without and at full slip, width and resistance (m)."""

    along: Expr
    across: Expr
    static: Expr
    sliding: Expr
    width: Expr
    resistance: Expr


def forces(c: Constants, s: Slip, f: Name) -> Forces:
    """Return forces and torques at the contact point; camber has no effect."""
    across = f(tan(s.alpha))
    whole = f(clipped(magnitude(s.kappa, across)))
    mu = s.friction * (c.static + (c.sliding - c.static) * whole)
    most = f(mu * s.load + Float(str(TINY)))
    critical = f(most / (2 * c.along))
    above = larger(f, s.kappa, critical)
    below = f(critical * s.kappa / above)
    fx = c.along * below + most * Rational(1, 2) * f(s.kappa - below) / above
    sideways = f(c.across * across / (3 * most))
    left = f(sideways / larger(f, sideways, 1))
    part = f(magnitude(left))
    full = 3 - 3 * part + part**2
    mz = most * c.width * left * (1 - part) ** 3 * s.direction
    trail = c.width * (1 - part) ** 3 / full * s.direction
    my = -c.resistance * s.load * s.direction
    x, y = (Curve(force, slope, ZERO, ZERO, mu, ZERO, ZERO) for force, slope in (
        (fx, c.along), (-most * left * full, -c.across),
    ))  # fmt: skip
    return Forces(x.force, y.force, ZERO, my, mz, x, y, Torque(mz, trail, ZERO))


def larger(f: Name, x: Expr, least: Expr) -> Expr:
    """Return the absolute value of a number, at least `least`; smooth at zero, and without rounding."""
    return f(least + above_zero(f(magnitude(x) - least)))


def wrench(p: Symbolic, s: Slip, f: Name, ellipse: str = "") -> Forces:
    """Return forces and torques of a tyre with the numbers of a property file."""
    return forces(Constants(p.CSLIP, p.CALPHA, p.UMAX, p.UMIN, p.WIDTH, p.ROLLING_RESISTANCE), s, f)


def relaxation_lengths(p: Symbolic, load: Expr, gamma: Expr, f: Name) -> tuple[Expr, Expr]:
    """Return the longitudinal and lateral relaxation length, m."""
    return p.RELAX_LENGTH_X, p.RELAX_LENGTH_Y


def rolling_radius(p: Symbolic, deflection: Expr, f: Name) -> Expr:
    """Return the effective rolling radius, m; as in Adams/Tire, it is the loaded radius."""
    return p.UNLOADED_RADIUS - deflection


FORMULA = Formula(wrench, lambda p, s, f: wrench(p, s, f).wrench, relaxation_lengths, rolling_radius)
"""Fiala tyre of a property file."""
