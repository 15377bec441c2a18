"""Magic Formula, MF-Tyre 5.2 and PAC2002: forces and torques of steady slip.

The equations accept symbols and numbers: `p` has the coefficients by name, `f` names common subexpressions.

Pacejka, Tire and Vehicle Dynamics (2006), sec. 4.3.2, with slip angle and camber as angles, and the nominal load FNOMIN
in place of the adapted one, as in MF-Tyre 5.2 and MSC Adams/Tire (PAC2002). The influence of the inflation pressure is
that of PAC2002: the equations of Besselink, Schmeitz, Pacejka, Vehicle System Dynamics 48 suppl. 1 (2010) 337-352, with
QPZ1, QPZ2, QPX1 and QPFZ1 for PPZ1, PPZ2, PPMX1 and PFZ1. QSX4 to QSX11 and QSY5 to QSY7 of PAC2002 are those of
Pacejka (2012), 4.E69 and 4.E70.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from sympy import Expr, Float, Rational, atan, cos, exp, pi, sin, sqrt, tan

from ..element import Symbolic
from ..roads.road import above_zero, magnitude

Name = Callable[[Expr], Expr]
ONE, ZERO = Rational(1), Rational(0)
LEAST_LOAD = Float("1e-12")
"""Offset of loads in divisors, N, for a tyre without contact; it is below rounding for a tyre on the road."""


COMBINED_MODES = ("4", "5")
"""Last digits of USE_MODE with combined slip; 5 includes turn slip."""
OF_MODES = {"0": "", "1": "fx my", "2": "fy mx mz", "3": "fx fy mx my mz"}
"""Forces and torques by the last digit of USE_MODE, without combined slip."""


@dataclass(frozen=True)
class Slip:
    """State of slip: load (N), kappa, alpha, gamma (rad), relative speed, direction, road friction, pressure increment."""

    load: Expr
    kappa: Expr
    alpha: Expr
    gamma: Expr
    speed: Expr
    direction: Expr
    friction: Expr
    dpi: Expr = Rational(0)

    @property
    def moving(self) -> Expr:
        """Factor of ply steer, conicity and camber thrust: 1 for a moving wheel, 0 at rest."""
        return self.direction**2


@dataclass(frozen=True)
class Curve:
    """Force D sin(C atan(B x - E (B x - atan(B x)))) + Sv in one direction, with its terms for other equations."""

    force: Expr
    stiffness: Expr
    B: Expr
    C: Expr
    mu: Expr
    horizontal: Expr
    vertical: Expr


@dataclass(frozen=True)
class Torque:
    """Aligning torque, N m, with pneumatic trail, m, and residual torque, N m."""

    whole: Expr
    trail: Expr
    residual: Expr


@dataclass(frozen=True)
class Forces:
    """Forces (N) and torques (N m) at the contact point, the curves of pure slip, and the aligning torque's parts."""

    fx: Expr
    fy: Expr
    mx: Expr
    my: Expr
    mz: Expr
    x: Curve
    y: Curve
    torque: Torque

    @property
    def wrench(self) -> tuple[Expr, Expr, Expr, Expr, Expr]:
        """Fx, Fy, Mx, My, Mz."""
        return self.fx, self.fy, self.mx, self.my, self.mz


def magic(b: Expr, x: Expr, c: Expr, curvature: Expr) -> Expr:
    """Return the argument of sine or cosine: C atan(B x - E (B x - atan(B x)))."""
    return c * atan(b * x - curvature * (b * x - atan(b * x)))


def sign(x: Expr) -> Expr:
    """Return the sign of a number, 0 at zero."""
    return x / magnitude(x)


def at_most_one(x: Expr) -> Expr:
    """Return min(x, 1)."""
    return 1 - above_zero(1 - x)


def divisor(stiffness: Expr) -> Expr:
    """Return a stiffness to divide by, which is not zero for a tyre without load."""
    return stiffness + sign(stiffness) * LEAST_LOAD + LEAST_LOAD**2


def longitudinal(p: Symbolic, s: Slip, dfz: Expr, f: Name) -> Curve:
    """Return the force of pure longitudinal slip."""
    gamma = s.gamma * p.LGAX
    shift = f((p.PHX1 + p.PHX2 * dfz) * p.LHX * s.moving)
    kappa = f(s.kappa + shift)
    pressure = 1 + p.PPX3 * s.dpi + p.PPX4 * s.dpi**2
    mu = f((p.PDX1 + p.PDX2 * dfz) * pressure * (1 - p.PDX3 * gamma**2) * p.LMUX * s.friction)
    E = f(at_most_one((p.PEX1 + p.PEX2 * dfz + p.PEX3 * dfz**2) * (1 - p.PEX4 * sign(kappa)) * p.LEX))
    K = f(s.load * (p.PKX1 + p.PKX2 * dfz) * exp(p.PKX3 * dfz) * (1 + p.PPX1 * s.dpi + p.PPX2 * s.dpi**2) * p.LKX)
    C = p.PCX1 * p.LCX
    B = f(K / (C * mu * s.load + LEAST_LOAD))
    vertical = f(s.load * (p.PVX1 + p.PVX2 * dfz) * p.LVX * p.LMUX * s.friction * s.moving)
    force = f(mu * s.load * sin(magic(B, kappa, C, E)) + vertical)
    return Curve(force, K, B, C, mu, shift, vertical)


def lateral(p: Symbolic, s: Slip, dfz: Expr, f: Name) -> Curve:
    """Return the force of pure lateral slip."""
    gamma = f(s.gamma * p.LGAY)
    shift = f(((p.PHY1 + p.PHY2 * dfz) * p.LHY + p.PHY3 * gamma) * s.moving)
    alpha = f(s.alpha + shift)
    pressure = 1 + p.PPY3 * s.dpi + p.PPY4 * s.dpi**2
    mu = f((p.PDY1 + p.PDY2 * dfz) * pressure * (1 - p.PDY3 * gamma**2) * p.LMUY * s.friction)
    E = f(at_most_one((p.PEY1 + p.PEY2 * dfz) * (1 - (p.PEY3 + p.PEY4 * gamma) * sign(alpha)) * p.LEY))
    stiffest = p.PKY2 * p.FNOMIN * p.LFZO * (1 + p.PPY2 * s.dpi)
    upright = p.PKY1 * p.FNOMIN * (1 + p.PPY1 * s.dpi) * sin(2 * atan(s.load / stiffest)) * p.LFZO * p.LKY
    K = f(upright * (1 - p.PKY3 * magnitude(gamma)))
    C = p.PCY1 * p.LCY
    B = f(K / (C * mu * s.load + LEAST_LOAD))
    sideways = f((p.PVY1 + p.PVY2 * dfz) * p.LVY + (p.PVY3 + p.PVY4 * dfz) * gamma)
    vertical = f(s.load * sideways * p.LMUY * s.friction * s.moving)
    force = f(mu * s.load * sin(magic(B, alpha, C, E)) + vertical)
    return Curve(force, K, B, C, mu, shift, vertical)


def weight(b: Expr, slip: Expr, shift: Expr, c: Expr, curvature: Expr, f: Name) -> Expr:
    """Return a weight of combined slip, 1 for zero slip."""
    return f(cos(magic(b, f(slip + shift), c, curvature)) / cos(magic(b, shift, c, curvature)))


def combined(
    p: Symbolic, s: Slip, x: Curve, y: Curve, dfz: Expr, f: Name, leaning: tuple[Expr, Expr] = (ZERO, ZERO), zeta: Expr = ONE
) -> tuple[Expr, Expr, Expr, Expr]:  # fmt: skip
    """Return Fx, Fy, the lateral force induced by longitudinal slip, and the factor G_yk on the side force.

    `leaning`: influence of camber on RBX1 and RBY1. `zeta`: that of turn slip on the induced force.
    """
    over_alpha = f((p.RBX1 + leaning[0]) * cos(atan(p.RBX2 * s.kappa)) * p.LXAL)
    E = at_most_one(p.REX1 + p.REX2 * dfz)
    fx = f(x.force * weight(over_alpha, s.alpha, p.RHX1, p.RCX1, f(E), f))
    over_kappa = f((p.RBY1 + leaning[1]) * cos(atan(p.RBY2 * (s.alpha - p.RBY3))) * p.LYKA)
    E = at_most_one(p.REY1 + p.REY2 * dfz)
    lessened = weight(over_kappa, s.kappa, f(p.RHY1 + p.RHY2 * dfz), p.RCY1, f(E), f)
    most = y.mu * s.load * (p.RVY1 + p.RVY2 * dfz + p.RVY3 * s.gamma) * cos(atan(p.RVY4 * s.alpha)) * zeta
    induced = f(most * sin(p.RVY5 * atan(p.RVY6 * s.kappa)) * p.LVYKA)
    return fx, f(y.force * lessened + induced), induced, lessened


def aligning(p: Symbolic, s: Slip, x: Curve, y: Curve, forces: tuple[Expr, Expr, Expr], dfz: Expr, f: Name) -> Torque:
    """Return the aligning torque: pneumatic trail, residual torque, and the arm of Fx."""
    fx, fy, induced = forces
    gamma, R = f(s.gamma * p.LGAZ), p.UNLOADED_RADIUS
    stiffer = p.LKY / p.LMUY
    B = f((p.QBZ1 + p.QBZ2 * dfz + p.QBZ3 * dfz**2) * (1 + p.QBZ4 * gamma + p.QBZ5 * magnitude(gamma)) * stiffer)
    D = s.load * (p.QDZ1 + p.QDZ2 * dfz) * (1 - p.QPZ1 * s.dpi)
    D = f(D * (1 + p.QDZ3 * gamma + p.QDZ4 * gamma**2) * (R / p.FNOMIN) * p.LTR)
    of_trail = f(s.alpha + p.QHZ1 + p.QHZ2 * dfz + (p.QHZ3 + p.QHZ4 * dfz) * gamma)
    of_rest = f(s.alpha + y.horizontal + y.vertical / divisor(y.stiffness))
    bent = 1 + (p.QEZ4 + p.QEZ5 * gamma) * (2 / pi) * atan(B * p.QCZ1 * of_trail)
    E = f(at_most_one((p.QEZ1 + p.QEZ2 * dfz + p.QEZ3 * dfz**2) * bent))
    driving = f((x.stiffness / divisor(y.stiffness) * s.kappa) ** 2)
    straight = cos(s.alpha) * s.direction  # reversed trail when rolling backward
    trail = f(D * cos(magic(B, f(equivalent(of_trail, driving)), p.QCZ1, E)) * straight)
    cambered = (p.QDZ8 + p.QDZ9 * dfz) * (1 + p.QPZ2 * s.dpi) * gamma
    residual_load = (p.QDZ6 + p.QDZ7 * dfz) * p.LRES + cambered
    residual_most = f(s.load * residual_load * R * p.LMUY * s.friction)
    slope = f(p.QBZ9 * stiffer + p.QBZ10 * y.B * y.C)
    residual = f(residual_most * cos(atan(slope * equivalent(of_rest, driving))) * straight)
    arm = f((p.SSZ1 + p.SSZ2 * fy / p.FNOMIN + (p.SSZ3 + p.SSZ4 * dfz) * s.gamma) * R * p.LS)
    return Torque(-trail * (fy - induced) + residual + arm * fx, trail, residual)


def equivalent(alpha: Expr, driving: Expr) -> Expr:
    """Return the magnitude of the equivalent slip angle of both slips.

    Trail and residual torque are even functions of it, and its sign would cause a discontinuity.
    """
    return atan(sqrt(tan(alpha) ** 2 + driving + Float("1e-60")))


def wrench(p: Symbolic, s: Slip, f: Name, ellipse: str = "") -> Forces:
    """Return forces and torques at the contact point.

    `ellipse`: name in `ELLIPSES` if there are no weights of combined slip; empty with weights.
    """
    dfz = increment(p, s.load, f)
    x, y = longitudinal(p, s, dfz, f), lateral(p, s, dfz, f)
    forces = ELLIPSES[ellipse](s, x, y, f) if ellipse else combined(p, s, x, y, dfz, f)[:3]
    mx, my = torques(p, s, forces[0], forces[1], f)
    torque = aligning(p, s, x, y, forces, dfz, f)
    return Forces(*forces[:2], mx, my, torque.whole, x, y, torque)


def uncombined(p: Symbolic, s: Slip, f: Name) -> tuple[Expr, Expr, Expr, Expr, Expr]:
    """Return Fx, Fy, Mx, My, Mz of separate slips: Fx, My by the longitudinal, the others by the slip angle."""
    dfz, none = increment(p, s.load, f), Rational(0)
    x, y = longitudinal(p, s, dfz, f), lateral(p, s, dfz, f)
    mx, my = torques(p, s, x.force, y.force, f)
    return x.force, y.force, mx, my, aligning(p, replace(s, kappa=none), x, y, (none, y.force, none), dfz, f).whole


@dataclass(frozen=True)
class Formula:
    """Functions of a version: forces and torques of combined slip, and those of separate slips.

    `relaxation_lengths` and `rolling_radius` are those of a tyre whose load depends on its deflection alone.
    """

    wrench: Callable[..., Forces]
    uncombined: Callable[..., tuple[Expr, Expr, Expr, Expr, Expr]]
    relaxation_lengths: Callable[..., tuple[Expr, Expr]] | None = None
    rolling_radius: Callable[..., Expr] | None = None


def of_mode(
    formula: Formula, mode: str, p: Symbolic, s: Slip, f: Name, ellipse: str
) -> tuple[Expr, Expr, Expr, Expr, Expr]:
    """Return the forces and torques selected by the last digit of USE_MODE, with zero for the others."""
    if mode in COMBINED_MODES:
        return formula.wrench(p, s, f, ellipse).wrench
    found, wanted = formula.uncombined(p, s, f), OF_MODES[mode].split()
    return tuple(x if name in wanted else Rational(0) for name, x in zip(OF_MODES["3"].split(), found, strict=True))  # type: ignore[return-value]


def relaxation_lengths(p: Symbolic, load: Expr, gamma: Expr, f: Name) -> tuple[Expr, Expr]:
    """Return the longitudinal and lateral relaxation length, m, by the equations of MF-Tyre 5.2."""
    dfz, R = increment(p, load, f), p.UNLOADED_RADIUS
    along = load * (p.PTX1 + p.PTX2 * dfz) * exp(-p.PTX3 * dfz) * R / p.FNOMIN * p.LSGKP
    by_load = sin(2 * atan(load / (p.PTY2 * p.FNOMIN * p.LFZO)))
    return along, p.PTY1 * by_load * (1 - p.PKY3 * magnitude(gamma * p.LGAY)) * R * p.LFZO * p.LSGAL


def increment(p: Symbolic, load: Expr, f: Name) -> Expr:
    """Return dfz, the relative deviation from the nominal load."""
    nominal = p.FNOMIN * p.LFZO
    return f((load - nominal) / nominal)


def torques(p: Symbolic, s: Slip, fx: Expr, fy: Expr, f: Name) -> tuple[Expr, Expr]:
    """Return the overturning and the rolling resistance torque."""
    R = p.UNLOADED_RADIUS
    part, side = f(s.load / p.FNOMIN), f(fy / p.FNOMIN)
    by_camber = p.QSX2 * (1 + p.QPX1 * s.dpi) * s.gamma
    shaped = shaped_overturning(p, part, side, s.gamma)
    mx = R * s.load * (p.QSX1 * p.LVMX + (-by_camber + p.QSX3 * side + shaped) * p.LMX)
    resistance = resistance_of(p, s, fx, part) * (part + LEAST_LOAD) ** p.QSY7
    pressed = 1 if s.dpi == 0 else (p.LIP * (1 + s.dpi)) ** p.QSY8  # of the nominal pressure without its scale factor
    return mx, -R * s.load * resistance * pressed * p.LMY * s.direction


def shaped_overturning(p: Symbolic, part: Expr, side: Expr, gamma: Expr) -> Expr:
    """Return the terms of QSX4 to QSX11 of the overturning torque over load and radius, by Fz/FNOMIN and Fy/FNOMIN."""
    hill = p.QSX4 * cos(p.QSX5 * atan((p.QSX6 * part) ** 2)) * sin(p.QSX7 * gamma + p.QSX8 * atan(p.QSX9 * side))
    return hill + p.QSX10 * atan(p.QSX11 * part) * gamma


def resistance_of(p: Symbolic, s: Slip, fx: Expr, part: Expr) -> Expr:
    """Return the rolling resistance by longitudinal force, speed, camber and load, QSY1 to QSY6."""
    cambered = (p.QSY5 + p.QSY6 * part) * s.gamma**2
    return p.QSY1 + p.QSY2 * fx / p.FNOMIN + p.QSY3 * s.speed + p.QSY4 * s.speed**4 + cambered


def on_ellipse(s: Slip, x: Curve, y: Curve, f: Name) -> tuple[Expr, Expr, Expr]:
    """Return Fx and Fy of pure slips, scaled down to the ellipse of mu_x N and mu_y N if they exceed it."""
    most_x, most_y = x.mu * s.load + LEAST_LOAD, y.mu * s.load + LEAST_LOAD
    beyond = f(magnitude(x.force / most_x, y.force / most_y))
    less = f(1 / (1 + above_zero(beyond - 1)))
    return f(x.force * less), f(y.force * less), Rational(0)


def within_ellipse(s: Slip, x: Curve, y: Curve, f: Name) -> tuple[Expr, Expr, Expr]:
    """Return Fx and Fy of combined slip by the friction ellipse of MSC Adams/Tire, PAC2002.

    With kappa_c and alpha* = sin(alpha_c), the slips from those without force, and the friction that is used, mu_act:
    Fx = Fx0/sqrt(1 + (mu_x,act tan(beta)/mu_y)^2), Fy = Fy0/sqrt(1 + (mu_y,act/(mu_x tan(beta)))^2), tan(beta) = abs(alpha*/kappa_c).
    """
    least = Float("1e-60")
    kappa = f(s.kappa + x.horizontal + x.vertical / (x.stiffness + LEAST_LOAD))
    alpha = f(sin(s.alpha + y.horizontal + y.vertical / divisor(y.stiffness)))
    most_x, most_y = x.mu * s.load + LEAST_LOAD, y.mu * s.load + LEAST_LOAD
    along, across = f((x.force - x.vertical) / most_y), f((y.force - y.vertical) / most_x)
    fx = x.force * sqrt((kappa**2 + least) / (kappa**2 + (along * alpha) ** 2 + least))
    fy = y.force * sqrt((alpha**2 + least) / (alpha**2 + (across * kappa) ** 2 + least))
    return f(fx), f(fy), Rational(0)


ELLIPSES = {"limit": on_ellipse, "pac2002": within_ellipse}
"""Combined slip without weights: a limit of both forces, and the friction ellipse of PAC2002."""


def rolling_radius(p: Symbolic, deflection: Expr, f: Name) -> Expr:
    """Return the effective rolling radius, m, by BREFF, DREFF and FREFF."""
    nominal = f(p.FNOMIN / p.VERTICAL_STIFFNESS)
    part = f(deflection / nominal)
    return p.UNLOADED_RADIUS - nominal * (p.DREFF * atan(p.BREFF * part) + p.FREFF * part)


FORMULA = Formula(wrench, uncombined, relaxation_lengths, rolling_radius)
"""MF-Tyre 5.2 and PAC2002."""
