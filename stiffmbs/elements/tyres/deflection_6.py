"""Deflection, load, radii and contact patch of Magic Formula 6.1 and 6.2.

Besselink, Schmeitz, Pacejka, An improved Magic Formula/Swift tyre model, Vehicle System Dynamics 48 suppl. 1 (2010),
eq. 1 to 10; Pacejka, Tire and Vehicle Dynamics (2012), A3.1 to A3.6; MF-Tyre/MF-Swift 6.2 for the camber terms.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Float, Rational, atan, sqrt, tan

from ..element import Expr, Symbolic
from ..roads.road import above_zero, magnitude

LEAST_DEFLECTION = Float("1e-12")
"""Offset of the deflection under a power, m, for a tyre without contact."""


def vertical_stiffness(p: Symbolic, dpi: Expr) -> Expr:
    """Return C_z, N/m, at the given pressure (eq. 5)."""
    return p.VERTICAL_STIFFNESS * (1 + p.PFZ1 * dpi)


def free_radius(p: Symbolic, spin: Expr) -> Expr:
    """Return R_Omega, the radius of the tyre without load, m, which grows with its spin, rad/s (eq. 1)."""
    R = p.UNLOADED_RADIUS
    return R * (p.Q_RE0 + p.Q_V1 * (spin * R / p.LONGVL) ** 2)


def effective_radius(p: Symbolic, load: Expr, dpi: Expr, free: Expr) -> Expr:
    """Return the effective rolling radius, m (eq. 7)."""
    part = load / p.FNOMIN
    return free - p.FNOMIN / vertical_stiffness(p, dpi) * (p.DREFF * atan(p.BREFF * part) + p.FREFF * part)


def deflection(p: Symbolic, loaded: Expr, free: Expr, gamma: Expr) -> Expr:
    """Return the vertical deflection, m, at a loaded radius; MF-Tyre 6.2 adds the part of camber.

    With a cambered tyre, the edge touches the road before its middle; the deflection is negative without contact.
    """
    middle = free - loaded
    if p.formula != "6.2":
        return middle
    tread = (Float("1.075") - p.ASPECT_RATIO / 2) * p.WIDTH
    above, below = ((p.Q_CAM1 * r + p.Q_CAM2 * r**2) ** 2 for r in (loaded, free))
    edge = above / (below + Float("1e-60")) * tread / 8 * magnitude(tan(gamma))
    return middle + edge - p.Q_CAM3 * above_zero(middle) * magnitude(gamma)


@dataclass(frozen=True)
class Stiffening:
    """Load as a quadratic function of the forces: whole (base - (along Fx)^2 - (across (Fy - shift))^2), N."""

    whole: Expr
    base: Expr
    along: Expr
    across: Expr
    shift: Expr

    def load(self, fx: Expr, fy: Expr) -> Expr:
        """Return the load, N."""
        return self.whole * (self.base - (self.along * fx) ** 2 - (self.across * (fy - self.shift)) ** 2)

    def load_at_ratios(self, of_fx: Expr, of_fy: Expr, more: Expr) -> Expr:
        """Return the load N at given ratios Fx/N and Fy/N, with a further force on it."""
        a = self.whole * ((self.along * of_fx) ** 2 + (self.across * of_fy) ** 2)
        b = 1 - 2 * self.whole * self.across**2 * of_fy * self.shift
        c = self.whole * (self.base - (self.across * self.shift) ** 2) + more
        return 2 * c / (b + sqrt(above_zero(b**2 + 4 * a * c) + Float("1e-60")))


def stiffening(p: Symbolic, loaded: Expr, free: Expr, spin: Expr, dpi: Expr, gamma: Expr) -> Stiffening:
    """Return the load of a deflected tyre as a function of its forces along the road (A3.3; MF-Tyre 6.2)."""
    R = p.UNLOADED_RADIUS
    rho = above_zero(deflection(p, loaded, free, gamma)) / R
    linear = sqrt((p.VERTICAL_STIFFNESS * R / p.FNOMIN) ** 2 - 4 * p.Q_FZ2)
    whole = (linear * rho + p.Q_FZ2 * rho**2) * (1 + p.PFZ1 * dpi) * p.FNOMIN
    base, across, shift = 1 + p.Q_V2 * R / p.LONGVL * magnitude(spin), p.Q_FCY / p.FNOMIN, Float(0)
    if p.formula == "6.2":
        across *= (rho + LEAST_DEFLECTION) ** p.Q_FCY2
        part = loaded / free
        shift = (p.Q_FYS1 + p.Q_FYS2 * part + p.Q_FYS3 * part**2) * gamma
    return Stiffening(whole, base, p.Q_FCX / p.FNOMIN, across, shift)


def contact_patch(p: Symbolic, load: Expr, dpi: Expr) -> tuple[Expr, Expr]:
    """Return half the length and half the width of the contact patch, m (eq. 9 and 10)."""
    part = load / (vertical_stiffness(p, dpi) * p.UNLOADED_RADIUS)
    length = p.UNLOADED_RADIUS * (p.Q_RA2 * part + p.Q_RA1 * sqrt(part))
    return length, p.WIDTH * (p.Q_RB2 * part + p.Q_RB1 * part ** Rational(1, 3))
