"""Magic Formula 6.1 and 6.2: forces and torques with inflation pressure, large camber and turn slip.

The equations accept symbols and numbers: `p` has the coefficients by name, `f` names common subexpressions.

Pacejka, Tire and Vehicle Dynamics (2012), sec. 4.3.2 and 4.3.3, equation numbers 4.E1 to 4.E78 and 4.75 to 4.107, in
ISO axes; Besselink, Schmeitz, Pacejka, An improved Magic Formula/Swift tyre model, Vehicle System Dynamics 48 suppl. 1
(2010) 337-352, equations A48 to A60. As in MF-Tyre, slip angle and camber are angles, and A_mu of 4.E8 is 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from sympy import Float, atan, cos, exp, pi, sin, sqrt, tan

from ..element import Expr, Symbolic
from ..roads.road import above_zero, magnitude
from . import magic_formula as earlier
from .magic_formula import LEAST_LOAD, ONE, ZERO, Curve, Name, Slip, Torque, at_most_one, divisor, magic, sign

ROUNDED = Float("1e-3")
"""Width over which the arccosine of 4.104 is rounded at 1, where its slope is infinite."""
LEAST_SPIN = Float("1e-12")
"""Offset of spin torques in divisors, N m."""


@dataclass(frozen=True)
class PressedSlip(Slip):
    """State of slip with phi_t and Omega/V of turn slip, both 1/m.

    phi_t is the yaw rate over the speed V of the contact point, positive in a turn to the left; None without turn slip.
    """

    turn: Expr = None
    rolling: Expr = ZERO


@dataclass(frozen=True)
class Spin:
    """Factors zeta of turn slip, shift of the side force, residual torque and its shape; neutral without turn slip."""

    of_fx: Expr = ONE
    of_fy: Expr = ONE
    of_stiffness: Expr = ONE
    of_trail: Expr = ONE
    of_residual: Expr = ONE
    of_camber: Expr = ONE
    shape: Expr = ONE
    torque: Expr = ZERO
    phi: Expr = None


def scaled_friction(p: Symbolic, s: PressedSlip, scale: Expr, f: Name) -> Expr:
    """Return lambda*_mu: the scale factor on the road's friction, which decays with the sliding speed (4.E7)."""
    sliding = s.speed * magnitude(s.kappa, tan(s.alpha))
    return f(scale * s.friction / (1 + p.LMUV * sliding))


def spin_of(p: Symbolic, s: PressedSlip, dfz: Expr, f: Name) -> Spin:
    """Return the influence of turn slip on the curves (4.76 to 4.79, 4.90, 4.91, 4.102, 4.105)."""
    if s.turn is None:
        return Spin()
    R = p.UNLOADED_RADIUS
    phi = f(R * (s.turn + (1 - camber_reduction(p, dfz)) * s.rolling * sin(s.gamma)))
    size = f(magnitude(phi))
    along = p.PDXP1 * (1 + p.PDXP2 * dfz) * cos(atan(p.PDXP3 * s.kappa))
    across = p.PDYP1 * (1 + p.PDYP2 * dfz) * cos(atan(p.PDYP3 * tan(s.alpha)))
    return Spin(
        of_fx=f(cos(atan(along * phi))),
        of_fy=f(cos(atan(across * (size + p.PDYP4 * sqrt(size + Float("1e-30")))))),
        of_stiffness=f(cos(atan(p.PKYP1 * phi**2))),
        of_trail=f(cos(atan(p.QDTP1 * phi))),
        of_residual=f(cos(atan(p.QBRP1 * phi))),
        of_camber=ZERO,
        phi=phi,
    )


def camber_reduction(p: Symbolic, dfz: Expr) -> Expr:
    """Return epsilon_gamma (4.90)."""
    return p.PECP1 * (1 + p.PECP2 * dfz)


def slip_stiffness(p: Symbolic, load: Expr, dpi: Expr, dfz: Expr) -> Expr:
    """Return Kxk, N (4.E15)."""
    pressure = 1 + p.PPX1 * dpi + p.PPX2 * dpi**2
    return load * (p.PKX1 + p.PKX2 * dfz) * exp(p.PKX3 * dfz) * pressure * p.LKX


def cornering_stiffness(p: Symbolic, load: Expr, dpi: Expr, gamma: Expr) -> Expr:
    """Return Kya, N/rad (4.E25)."""
    nominal = p.FNOMIN * p.LFZO
    peak = (p.PKY2 + p.PKY5 * gamma**2) * (1 + p.PPY2 * dpi)
    shape = sin(p.PKY4 * atan(load / nominal / peak))
    return p.PKY1 * nominal * (1 + p.PPY1 * dpi) * (1 - p.PKY3 * magnitude(gamma)) * shape * p.LKY


def camber_stiffness(p: Symbolic, load: Expr, dpi: Expr, dfz: Expr) -> Expr:
    """Return Kyg0, N/rad (4.E30)."""
    return load * (p.PKY6 + p.PKY7 * dfz) * (1 + p.PPY5 * dpi) * p.LKYC


def longitudinal(p: Symbolic, s: PressedSlip, dfz: Expr, spin: Spin, f: Name) -> Curve:
    """Return the force of pure longitudinal slip (4.E9 to 4.E18)."""
    shift = f((p.PHX1 + p.PHX2 * dfz) * p.LHX * s.moving)
    kappa, friction = f(s.kappa + shift), scaled_friction(p, s, p.LMUX, f)
    pressure = 1 + p.PPX3 * s.dpi + p.PPX4 * s.dpi**2
    mu = f((p.PDX1 + p.PDX2 * dfz) * pressure * (1 - p.PDX3 * s.gamma**2) * friction)
    E = f(at_most_one((p.PEX1 + p.PEX2 * dfz + p.PEX3 * dfz**2) * (1 - p.PEX4 * sign(kappa)) * p.LEX))
    K, C = f(slip_stiffness(p, s.load, s.dpi, dfz)), p.PCX1 * p.LCX
    D = f(mu * s.load * spin.of_fx)
    B = f(K / (C * D + LEAST_LOAD))
    vertical = f(s.load * (p.PVX1 + p.PVX2 * dfz) * p.LVX * friction * spin.of_fx * s.moving)
    return Curve(f(D * sin(magic(B, kappa, C, E)) + vertical), K, B, C, mu, shift, vertical)


def lateral(p: Symbolic, s: PressedSlip, dfz: Expr, spin: Spin, f: Name) -> Curve:
    """Return the force of pure lateral slip (4.E19 to 4.E30)."""
    gamma, friction = s.gamma, scaled_friction(p, s, p.LMUY, f)
    K = f(cornering_stiffness(p, s.load, s.dpi, gamma) * spin.of_stiffness)
    of_camber = f(s.load * (p.PVY3 + p.PVY4 * dfz) * gamma * p.LKYC * friction * spin.of_fy)
    thrust = f(camber_stiffness(p, s.load, s.dpi, dfz))
    if spin.phi is None:
        cambered = (thrust * gamma - of_camber) / divisor(K)
    else:
        cambered = spin_shift(p, s, dfz, spin, thrust, f) - of_camber / divisor(K)
    shift = f(((p.PHY1 + p.PHY2 * dfz) * p.LHY + cambered) * s.moving)
    alpha = f(s.alpha + shift)
    pressure = 1 + p.PPY3 * s.dpi + p.PPY4 * s.dpi**2
    mu = f((p.PDY1 + p.PDY2 * dfz) * pressure * (1 - p.PDY3 * gamma**2) * friction)
    curved = 1 + p.PEY5 * gamma**2 - (p.PEY3 + p.PEY4 * gamma) * sign(alpha)
    E = f(at_most_one((p.PEY1 + p.PEY2 * dfz) * curved * p.LEY))
    C, D = p.PCY1 * p.LCY, f(mu * s.load * spin.of_fy)
    B = f(K / (C * D + LEAST_LOAD))
    upright = s.load * (p.PVY1 + p.PVY2 * dfz) * p.LVY * friction * spin.of_fy
    vertical = f((upright + of_camber) * s.moving)
    return Curve(f(D * sin(magic(B, alpha, C, E)) + vertical), K, B, C, mu, shift, vertical)


def spin_shift(p: Symbolic, s: PressedSlip, dfz: Expr, spin: Spin, thrust: Expr, f: Name) -> Expr:
    """Return the shift of the slip angle by spin, S_Hy,phi (4.80 to 4.89).

    In reverse the same path has the opposite phi and the same side force.
    """
    C, D = p.PHYP1, f(p.PHYP2 + p.PHYP3 * dfz)
    upright = cornering_stiffness(p, s.load, s.dpi, ZERO) * spin.of_stiffness
    stiffness = thrust / (1 - camber_reduction(p, dfz))
    x = f(stiffness / (C * D * divisor(f(upright)) + LEAST_LOAD**2) * spin.phi)
    return f(D * sin(magic(ONE, x, C, at_most_one(p.PHYP4))) * s.direction)


def with_torque(p: Symbolic, s: PressedSlip, y: Curve, lessened: Expr, dfz: Expr, spin: Spin, f: Name) -> Spin:
    """Return the spin with its residual torque and its shape, D_r,phi and zeta_7 (4.93 to 4.99, 4.103, 4.104)."""
    if spin.phi is None:
        return spin
    R, C = p.UNLOADED_RADIUS, p.QDRP1
    most = f(p.QCRP1 * magnitude(y.mu) * R * s.load * sqrt(s.load / (p.FNOMIN * p.LFZO) + Float("1e-30")) * p.LMP)
    D = f(most / sin(pi / 2 * C))
    stiffness = s.load * R * (p.QDZ8 + p.QDZ9 * dfz + (p.QDZ10 + p.QDZ11 * dfz) * magnitude(s.gamma)) * p.LKZC
    x = f(stiffness / (C * D * (1 - camber_reduction(p, dfz)) + LEAST_SPIN) * spin.phi)
    torque = f(D * sin(magic(ONE, x, C, p.QDRP2)))
    # G_yk is below zero at large slip where RCY1 > 1; the arccosine has no value there
    by_turn = most * 2 / pi * atan(p.QCRP2 * R * magnitude(s.turn)) * above_zero(lessened)
    left = f(above_zero(f(1 - by_turn / (magnitude(torque) + LEAST_SPIN))))
    left = f(magnitude(left, ROUNDED) / magnitude(ONE, ROUNDED))
    angle = 2 * atan(sqrt(left / (2 - left)))  # arccos(1 - left)
    return replace(spin, torque=torque, shape=f(2 / pi * angle))


def aligning(
    p: Symbolic, s: PressedSlip, x: Curve, y: Curve, forces: tuple[Expr, Expr, Expr], dfz: Expr, spin: Spin, f: Name
) -> Torque:
    """Return the aligning torque (4.E33 to 4.E49, 4.E71 to 4.E78; A54 to A60)."""
    fx, fy, lessened = forces
    gamma, R = s.gamma, p.UNLOADED_RADIUS
    friction = scaled_friction(p, s, p.LMUY, f)
    stiffer = f(p.LKY / (friction + LEAST_LOAD))
    spin = with_torque(p, s, y, lessened, dfz, spin, f)
    B = f((p.QBZ1 + p.QBZ2 * dfz + p.QBZ3 * dfz**2) * (1 + p.QBZ4 * gamma + p.QBZ5 * magnitude(gamma)) * stiffer)
    leaning = 1 + p.QDZ3 * gamma + p.QDZ4 * gamma**2
    D = f(s.load * (p.QDZ1 + p.QDZ2 * dfz) * (1 - p.PPZ1 * s.dpi) * leaning * (R / p.FNOMIN) * p.LTR * spin.of_trail)
    of_trail = f(s.alpha + p.QHZ1 + p.QHZ2 * dfz + (p.QHZ3 + p.QHZ4 * dfz) * gamma)
    of_rest = f(s.alpha + y.horizontal + y.vertical / divisor(y.stiffness))
    bent = 1 + (p.QEZ4 + p.QEZ5 * gamma) * (2 / pi) * atan(B * p.QCZ1 * of_trail)
    E = f(at_most_one((p.QEZ1 + p.QEZ2 * dfz + p.QEZ3 * dfz**2) * bent))
    driving = f((x.stiffness / divisor(y.stiffness) * s.kappa) ** 2)
    straight = f(cos(s.alpha) * s.direction)
    trail = f(D * cos(magic(B, f(earlier.equivalent(of_trail, driving)), p.QCZ1, E)) * straight)
    upright = lateral(p, replace(s, gamma=ZERO, turn=None), dfz, Spin(), f).force
    cambered = (p.QDZ8 + p.QDZ9 * dfz) * (1 + p.PPZ2 * s.dpi) + (p.QDZ10 + p.QDZ11 * dfz) * magnitude(gamma)
    at_rest = (p.QDZ6 + p.QDZ7 * dfz) * p.LRES * spin.of_fy + cambered * gamma * p.LKZC * spin.of_camber
    most = f(s.load * at_rest * R * friction * straight + spin.torque)
    slope = f((p.QBZ9 * stiffer + p.QBZ10 * y.B * y.C) * spin.of_residual)
    residual = f(most * cos(spin.shape * atan(slope * earlier.equivalent(of_rest, driving))))
    arm = f((p.SSZ1 + p.SSZ2 * fy / p.FNOMIN + (p.SSZ3 + p.SSZ4 * dfz) * gamma) * R * p.LS)
    return Torque(-trail * upright * lessened + residual + arm * fx, trail, residual)


def overturning(p: Symbolic, s: PressedSlip, fy: Expr, f: Name) -> Expr:
    """Return the overturning torque (P draft eq. 49, MF-Tyre 6.2)."""
    R, gamma, part, side = p.UNLOADED_RADIUS, s.gamma, f(s.load / p.FNOMIN), f(fy / p.FNOMIN)
    size = magnitude(gamma)
    by_load = (
        p.QSX1 * p.LVMX - p.QSX2 * gamma * (1 + p.PPMX1 * s.dpi) + p.QSX3 * side
        + earlier.shaped_overturning(p, part, side, gamma) - p.QSX12 * gamma * size
    )  # fmt: skip
    return R * p.LMX * (s.load * by_load + fy * (p.QSX13 + p.QSX14 * size))


def rolling_resistance(p: Symbolic, s: PressedSlip, fx: Expr, f: Name) -> Expr:
    """Return the rolling resistance torque (A48)."""
    part = f(s.load / p.FNOMIN)
    of_load = part * (part + LEAST_LOAD) ** (p.QSY7 - 1)  # with a finite slope at zero load
    upright = p.FNOMIN * earlier.resistance_of(p, s, fx, part) * of_load * (1 + s.dpi) ** p.QSY8
    return -p.UNLOADED_RADIUS * upright * p.LMY * s.direction


def slip_forces(p: Symbolic, s: PressedSlip, f: Name, mode: str, ellipse: str) -> tuple[Expr, Expr]:
    """Return Fx and Fy, as selected by the last digit of USE_MODE."""
    dfz = earlier.increment(p, s.load, f)
    spin = spin_of(p, s, dfz, f)
    x, y = longitudinal(p, s, dfz, spin, f), lateral(p, s, dfz, spin, f)
    if mode in earlier.COMBINED_MODES:
        return _combined(p, s, x, y, dfz, spin, f, ellipse)[:2]
    wanted = earlier.OF_MODES[mode].split()
    return x.force if "fx" in wanted else ZERO, y.force if "fy" in wanted else ZERO


def _combined(
    p: Symbolic, s: PressedSlip, x: Curve, y: Curve, dfz: Expr, spin: Spin, f: Name, ellipse: str
) -> tuple[Expr, Expr, Expr]:
    """Return Fx, Fy, and the factor G_yk on the side force (4.E50 to 4.E67)."""
    if ellipse:
        fx, fy, _ = earlier.ELLIPSES[ellipse](s, x, y, f)
        return fx, fy, fy / divisor(y.force)
    leaning = p.RBX3 * s.gamma**2, p.RBY4 * s.gamma**2
    fx, fy, _, lessened = earlier.combined(p, s, x, y, dfz, f, leaning, spin.of_fy)
    return fx, fy, lessened


def wrench(p: Symbolic, s: PressedSlip, f: Name, ellipse: str = "") -> earlier.Forces:
    """Return forces and torques of combined slip."""
    dfz = earlier.increment(p, s.load, f)
    spin = spin_of(p, s, dfz, f)
    x, y = longitudinal(p, s, dfz, spin, f), lateral(p, s, dfz, spin, f)
    forces = _combined(p, s, x, y, dfz, spin, f, ellipse)
    torque = aligning(p, s, x, y, forces, dfz, spin, f)
    fx, fy, _ = forces
    return earlier.Forces(fx, fy, overturning(p, s, fy, f), rolling_resistance(p, s, fx, f), torque.whole, x, y, torque)


def uncombined(p: Symbolic, s: PressedSlip, f: Name) -> tuple[Expr, Expr, Expr, Expr, Expr]:
    """Return Fx, Fy, Mx, My, Mz of separate slips: Fx, My by the longitudinal, the others by the slip angle."""
    dfz, spin = earlier.increment(p, s.load, f), Spin()
    x, y = longitudinal(p, s, dfz, spin, f), lateral(p, s, dfz, spin, f)
    torque = aligning(p, replace(s, kappa=ZERO), x, y, (ZERO, y.force, ONE), dfz, spin, f)
    return x.force, y.force, overturning(p, s, y.force, f), rolling_resistance(p, s, x.force, f), torque.whole


FORMULA = earlier.Formula(wrench, uncombined)
"""Versions 6.1 and 6.2."""


def relaxation_lengths(p: Symbolic, load: Expr, dpi: Expr, gamma: Expr, f: Name) -> tuple[Expr, Expr]:
    """Return the longitudinal and lateral relaxation length, m, Kxk/Cx and -Kya/Cy, negative where a stiffness has the wrong sign.

    Besselink, Schmeitz, Pacejka (2010), eq. 17 to 19.
    """
    dfz = earlier.increment(p, load, f)
    along = p.LONGITUDINAL_STIFFNESS * (1 + p.PCFX1 * dfz + p.PCFX2 * dfz**2) * (1 + p.PCFX3 * dpi)
    across = p.LATERAL_STIFFNESS * (1 + p.PCFY1 * dfz + p.PCFY2 * dfz**2) * (1 + p.PCFY3 * dpi)
    return (f(slip_stiffness(p, load, dpi, dfz) / along), f(-cornering_stiffness(p, load, dpi, gamma) / across))
