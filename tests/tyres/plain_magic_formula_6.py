"""The Magic Formula 6.1 and 6.2 in plain floating-point arithmetic, written from its published equations alone.

Pacejka, Tire and Vehicle Dynamics (2012), sec. 4.3.2 and 4.3.3, in ISO axes with angles in place of their tangent and
sine; rolling resistance, trail and overturning torque as in Besselink, Schmeitz, Pacejka (2010) and MF-Tyre 6.2.  All
epsilons are zero.  Numbers of the equations are those of the book.
"""

from math import acos, atan, cos, exp, pi, sin, sqrt, tan
from types import SimpleNamespace

from .plain_magic_formula import _bend, _sgn


def plain_wrench_6(coefficients, state):
    """Forces, torques, stiffnesses and relaxation lengths, by the symbols of the formula; phit None is without turn slip.

    State: Fz, kappa, alpha, gamma, p, Vx, phit, mu (the road's friction), Re.
    """
    c, s = SimpleNamespace(**coefficients), SimpleNamespace(**state)
    Fz, kappa, alpha, gamma = s.Fz, s.kappa, s.alpha, s.gamma
    R0, Fz0, Fz0s = c.UNLOADED_RADIUS, c.FNOMIN, c.LFZO * c.FNOMIN
    dfz, dpi = Fz / Fz0s - 1, (s.p - c.NOMPRES) / c.NOMPRES  # 4.E2
    ahead = _sgn(s.Vx)
    sliding = abs(s.Vx) / c.LONGVL * sqrt(kappa**2 + tan(alpha) ** 2)  # Vs/V0
    lmux, lmuy = (x * s.mu / (1 + c.LMUV * sliding) for x in (c.LMUX, c.LMUY))  # 4.E7

    z = dict.fromkeys(range(9), 1.0)
    epsilon = c.PECP1 * (1 + c.PECP2 * dfz)  # 4.90
    turning = s.phit is not None
    if turning:
        # 4.75: phi = (psi' - (1 - epsilon) Omega sin(gamma))/V in the axes of the book, where yaw has the other sign
        spin = (1 + kappa) * cos(alpha) * ahead / s.Re
        phi = R0 * (s.phit + (1 - epsilon) * spin * sin(gamma))
        Bxphi = c.PDXP1 * (1 + c.PDXP2 * dfz) * cos(atan(c.PDXP3 * kappa))
        Byphi = c.PDYP1 * (1 + c.PDYP2 * dfz) * cos(atan(c.PDYP3 * tan(alpha)))
        z[0] = 0.0
        z[1] = cos(atan(Bxphi * phi))
        z[2] = cos(atan(Byphi * (abs(phi) + c.PDYP4 * sqrt(abs(phi)))))
        z[3] = cos(atan(c.PKYP1 * phi**2))
        z[5] = cos(atan(c.QDTP1 * phi))
        z[6] = cos(atan(c.QBRP1 * phi))

    # 4.E9 to 4.E18
    SVx = Fz * (c.PVX1 + c.PVX2 * dfz) * c.LVX * lmux * z[1]
    kx = kappa + (c.PHX1 + c.PHX2 * dfz) * c.LHX
    mux = (c.PDX1 + c.PDX2 * dfz) * (1 + c.PPX3 * dpi + c.PPX4 * dpi**2) * (1 - c.PDX3 * gamma**2) * lmux
    Cx, Dx = c.PCX1 * c.LCX, mux * Fz * z[1]
    Ex = min((c.PEX1 + c.PEX2 * dfz + c.PEX3 * dfz**2) * (1 - c.PEX4 * _sgn(kx)) * c.LEX, 1)
    Kxk = Fz * (c.PKX1 + c.PKX2 * dfz) * exp(c.PKX3 * dfz) * (1 + c.PPX1 * dpi + c.PPX2 * dpi**2) * c.LKX
    Fx0 = Dx * sin(Cx * atan(_bend(Kxk / (Cx * Dx), kx, Ex))) + SVx

    def cornering(g):  # 4.E25
        peak = (c.PKY2 + c.PKY5 * g**2) * (1 + c.PPY2 * dpi)
        part = sin(c.PKY4 * atan(Fz / Fz0s / peak))
        return c.PKY1 * Fz0s * (1 + c.PPY1 * dpi) * (1 - c.PKY3 * abs(g)) * part * z3 * c.LKY

    Kyg0 = Fz * (c.PKY6 + c.PKY7 * dfz) * (1 + c.PPY5 * dpi) * c.LKYC  # 4.E30

    def side(g, z2, z3_, shift_of):  # 4.E19 to 4.E29
        SVyg = Fz * (c.PVY3 + c.PVY4 * dfz) * g * c.LKYC * lmuy * z2
        SVy = Fz * (c.PVY1 + c.PVY2 * dfz) * c.LVY * lmuy * z2 + SVyg
        Kya = cornering(g)
        SHy = (c.PHY1 + c.PHY2 * dfz) * c.LHY + shift_of(g, SVyg, Kya)
        ay = alpha + SHy
        muy = (c.PDY1 + c.PDY2 * dfz) * (1 + c.PPY3 * dpi + c.PPY4 * dpi**2) * (1 - c.PDY3 * g**2) * lmuy
        Cy, Dy = c.PCY1 * c.LCY, muy * Fz * z2
        Ey = min((c.PEY1 + c.PEY2 * dfz) * (1 + c.PEY5 * g**2 - (c.PEY3 + c.PEY4 * g) * _sgn(ay)) * c.LEY, 1)
        By = Kya / (Cy * Dy)
        return Dy * sin(Cy * atan(_bend(By, ay, Ey))) + SVy, Kya, SHy, SVy, muy, By, Cy

    def by_camber(g, SVyg, Kya):  # 4.E27, zeta_0 = zeta_4 = 1
        return (Kyg0 * g - SVyg) / Kya

    def by_spin(g, SVyg, Kya):  # zeta_4 = 1 + S_Hy,phi - S_Vy,gamma/K_ya (4.80 to 4.89)
        C, D = c.PHYP1, c.PHYP2 + c.PHYP3 * dfz
        KR = Kyg0 / (1 - epsilon)
        B = KR / (C * D * cornering(0.0))
        E = min(c.PHYP4, 1)
        return D * sin(C * atan(_bend(B, phi, E))) * ahead - SVyg / Kya

    z3 = z[3]
    Fy0, Kya, SHy, SVy, muy, By, Cy = side(gamma, z[2], z[3], by_spin if turning else by_camber)

    # 4.E50 to 4.E67
    Bxa = (c.RBX1 + c.RBX3 * gamma**2) * cos(atan(c.RBX2 * kappa)) * c.LXAL
    Exa = min(c.REX1 + c.REX2 * dfz, 1)
    Gxa = cos(c.RCX1 * atan(_bend(Bxa, alpha + c.RHX1, Exa))) / cos(c.RCX1 * atan(_bend(Bxa, c.RHX1, Exa)))
    Byk = (c.RBY1 + c.RBY4 * gamma**2) * cos(atan(c.RBY2 * (alpha - c.RBY3))) * c.LYKA
    Eyk, SHyk = min(c.REY1 + c.REY2 * dfz, 1), c.RHY1 + c.RHY2 * dfz
    Gyk = cos(c.RCY1 * atan(_bend(Byk, kappa + SHyk, Eyk))) / cos(c.RCY1 * atan(_bend(Byk, SHyk, Eyk)))
    DVyk = muy * Fz * (c.RVY1 + c.RVY2 * dfz + c.RVY3 * gamma) * cos(atan(c.RVY4 * alpha)) * z[2]
    Fx, Fy = Gxa * Fx0, Gyk * Fy0 + DVyk * sin(c.RVY5 * atan(c.RVY6 * kappa)) * c.LVYKA

    # 4.E33 to 4.E49, 4.E71 to 4.E78
    ca, stiffer = cos(alpha) * ahead, c.LKY / lmuy
    at = alpha + c.QHZ1 + c.QHZ2 * dfz + (c.QHZ3 + c.QHZ4 * dfz) * gamma
    ar = alpha + SHy + SVy / Kya
    Bt = (c.QBZ1 + c.QBZ2 * dfz + c.QBZ3 * dfz**2) * (1 + c.QBZ4 * gamma + c.QBZ5 * abs(gamma)) * stiffer
    leaning = 1 + c.QDZ3 * gamma + c.QDZ4 * gamma**2
    Dt = Fz * R0 / Fz0 * (c.QDZ1 + c.QDZ2 * dfz) * (1 - c.PPZ1 * dpi) * leaning * c.LTR * z[5]
    Et = (c.QEZ1 + c.QEZ2 * dfz + c.QEZ3 * dfz**2) * (1 + (c.QEZ4 + c.QEZ5 * gamma) * 2 / pi * atan(Bt * c.QCZ1 * at))
    ateq, areq = (_sgn(a) * atan(sqrt(tan(a) ** 2 + (Kxk / Kya * kappa) ** 2)) for a in (at, ar))
    t = Dt * cos(c.QCZ1 * atan(_bend(Bt, ateq, min(Et, 1)))) * ca
    z3, straight = 1.0, (0.0, 1.0, 1.0, by_camber)
    Fyp = Gyk * side(*straight)[0]  # at gamma = phi = 0
    cambered = (c.QDZ8 + c.QDZ9 * dfz) * (1 + c.PPZ2 * dpi) + (c.QDZ10 + c.QDZ11 * dfz) * abs(gamma)
    Dr = Fz * R0 * ((c.QDZ6 + c.QDZ7 * dfz) * c.LRES * z[2] + cambered * gamma * c.LKZC * z[0]) * lmuy * ca
    if turning:  # 4.93 to 4.99, 4.103, 4.104
        most = c.QCRP1 * abs(muy) * R0 * Fz * sqrt(Fz / Fz0s) * c.LMP
        D = most / sin(pi / 2 * c.QDRP1)
        stiffness = Fz * R0 * (c.QDZ8 + c.QDZ9 * dfz + (c.QDZ10 + c.QDZ11 * dfz) * abs(gamma)) * c.LKZC
        B = stiffness / (c.QDRP1 * D * (1 - epsilon))
        Drphi = D * sin(c.QDRP1 * atan(_bend(B, phi, min(c.QDRP2, 1))))
        by_turn = most * 2 / pi * atan(c.QCRP2 * R0 * abs(s.phit)) * max(Gyk, 0)  # a weight, not below zero
        z[7] = 2 / pi * acos(min(by_turn / abs(Drphi), 1))
        Dr += Drphi
    Br = (c.QBZ9 * stiffer + c.QBZ10 * By * Cy) * z[6]
    Mzr = Dr * cos(z[7] * atan(Br * areq))
    arm = R0 * (c.SSZ1 + c.SSZ2 * Fy / Fz0 + (c.SSZ3 + c.SSZ4 * dfz) * gamma) * c.LS
    Mz = -t * Fyp + Mzr + arm * Fx

    # overturning torque and rolling resistance
    n, side_n = Fz / Fz0, Fy / Fz0
    hill = c.QSX4 * cos(c.QSX5 * atan((c.QSX6 * n) ** 2)) * sin(c.QSX7 * gamma + c.QSX8 * atan(c.QSX9 * side_n))
    parts = c.QSX1 * c.LVMX - c.QSX2 * gamma * (1 + c.PPMX1 * dpi) + c.QSX3 * side_n + hill
    parts += c.QSX10 * atan(c.QSX11 * n) * gamma - c.QSX12 * gamma * abs(gamma)
    Mx = R0 * c.LMX * (Fz * parts + Fy * (c.QSX13 + c.QSX14 * abs(gamma)))
    v = abs(s.Vx) / c.LONGVL
    of_speed = c.QSY1 + c.QSY2 * Fx / Fz0 + c.QSY3 * v + c.QSY4 * v**4 + (c.QSY5 + c.QSY6 * n) * gamma**2
    My = -R0 * Fz0 * of_speed * n**c.QSY7 * (s.p / c.NOMPRES) ** c.QSY8 * c.LMY * ahead

    along = c.LONGITUDINAL_STIFFNESS * (1 + c.PCFX1 * dfz + c.PCFX2 * dfz**2) * (1 + c.PCFX3 * dpi)
    across = c.LATERAL_STIFFNESS * (1 + c.PCFY1 * dfz + c.PCFY2 * dfz**2) * (1 + c.PCFY3 * dpi)
    return {
        "Fx": Fx, "Fy": Fy, "Mx": Mx, "My": My, "Mz": Mz, "Kxk": Kxk, "Kya": Kya, "Kyg0": Kyg0, "mux": mux, "muy": muy,
        "t": t, "Mzr": Mzr, "sigma_x": abs(Kxk / along), "sigma_y": abs(cornering(gamma) / across),
    }  # fmt: skip
