"""The Magic Formula of MF-Tyre 5.2 in plain floating-point arithmetic, written from its published equations alone.

Pacejka, Tire and Vehicle Dynamics (2006), sec. 4.3.2, with angles in place of their tangent and sine.  Numbers of the equations are those there.
"""

from math import atan, copysign, cos, exp, pi, sin, sqrt, tan
from types import SimpleNamespace


def _sgn(x):
    return copysign(1.0, x) if x else 0.0


def _bend(B, x, E):
    return B * x - E * (B * x - atan(B * x))


OF_PRESSURE = ["PPX1", "PPX2", "PPX3", "PPX4", "PPY1", "PPY2", "PPY3", "PPY4", "QPZ1", "QPZ2", "QPX1", "QSY8"]
OF_TORQUES = ["QSX4", "QSX5", "QSX6", "QSX7", "QSX8", "QSX9", "QSX10", "QSX11", "QSY5", "QSY6", "QSY7"]


def plain_wrench(coefficients, load, kappa, alpha, gamma, speed_ratio=1.0, dpi=0.0):
    """Fx, Fy, Mx, My, Mz of combined slip, rolling forward; dpi is the pressure increment of PAC2002."""
    c = SimpleNamespace(**{**dict.fromkeys(OF_PRESSURE + OF_TORQUES, 0.0), "LIP": 1.0, **coefficients})
    Fz, Fz0, R0 = load, c.FNOMIN, c.UNLOADED_RADIUS
    Fz0s = Fz0 * c.LFZO
    dfz = (Fz - Fz0s) / Fz0s
    gx, gy, gz = gamma * c.LGAX, gamma * c.LGAY, gamma * c.LGAZ
    # 4.E9 to 4.E18
    kx = kappa + (c.PHX1 + c.PHX2 * dfz) * c.LHX
    mux = (c.PDX1 + c.PDX2 * dfz) * (1 - c.PDX3 * gx**2) * c.LMUX * (1 + c.PPX3 * dpi + c.PPX4 * dpi**2)
    Ex = min((c.PEX1 + c.PEX2 * dfz + c.PEX3 * dfz**2) * (1 - c.PEX4 * _sgn(kx)) * c.LEX, 1)
    Kx = Fz * (c.PKX1 + c.PKX2 * dfz) * exp(c.PKX3 * dfz) * c.LKX * (1 + c.PPX1 * dpi + c.PPX2 * dpi**2)
    Cx, Dx = c.PCX1 * c.LCX, mux * Fz
    Fx0 = Dx * sin(Cx * atan(_bend(Kx / (Cx * Dx), kx, Ex))) + Fz * (c.PVX1 + c.PVX2 * dfz) * c.LVX * c.LMUX
    # 4.E19 to 4.E30
    SHy = (c.PHY1 + c.PHY2 * dfz) * c.LHY + c.PHY3 * gy
    SVy = Fz * ((c.PVY1 + c.PVY2 * dfz) * c.LVY + (c.PVY3 + c.PVY4 * dfz) * gy) * c.LMUY
    ay = alpha + SHy
    muy = (c.PDY1 + c.PDY2 * dfz) * (1 - c.PDY3 * gy**2) * c.LMUY * (1 + c.PPY3 * dpi + c.PPY4 * dpi**2)
    Ey = min((c.PEY1 + c.PEY2 * dfz) * (1 - (c.PEY3 + c.PEY4 * gy) * _sgn(ay)) * c.LEY, 1)
    Fzmax = c.PKY2 * Fz0s * (1 + c.PPY2 * dpi)
    Ky = c.PKY1 * Fz0 * (1 + c.PPY1 * dpi) * sin(2 * atan(Fz / Fzmax)) * c.LFZO * c.LKY * (1 - c.PKY3 * abs(gy))
    Cy, Dy = c.PCY1 * c.LCY, muy * Fz
    By = Ky / (Cy * Dy)
    Fy0 = Dy * sin(Cy * atan(_bend(By, ay, Ey))) + SVy
    # 4.E50 to 4.E67
    Bxa = c.RBX1 * cos(atan(c.RBX2 * kappa)) * c.LXAL
    Exa = min(c.REX1 + c.REX2 * dfz, 1)
    Fx = Fx0 * cos(c.RCX1 * atan(_bend(Bxa, alpha + c.RHX1, Exa))) / cos(c.RCX1 * atan(_bend(Bxa, c.RHX1, Exa)))
    Byk = c.RBY1 * cos(atan(c.RBY2 * (alpha - c.RBY3))) * c.LYKA
    Eyk, SHyk = min(c.REY1 + c.REY2 * dfz, 1), c.RHY1 + c.RHY2 * dfz
    Gyk = cos(c.RCY1 * atan(_bend(Byk, kappa + SHyk, Eyk))) / cos(c.RCY1 * atan(_bend(Byk, SHyk, Eyk)))
    DVyk = muy * Fz * (c.RVY1 + c.RVY2 * dfz + c.RVY3 * gamma) * cos(atan(c.RVY4 * alpha))
    SVyk = DVyk * sin(c.RVY5 * atan(c.RVY6 * kappa)) * c.LVYKA
    Fy = Gyk * Fy0 + SVyk
    # 4.E31 to 4.E49, 4.E71 to 4.E78
    at = alpha + c.QHZ1 + c.QHZ2 * dfz + (c.QHZ3 + c.QHZ4 * dfz) * gz
    ar = alpha + SHy + SVy / Ky
    Bt = (c.QBZ1 + c.QBZ2 * dfz + c.QBZ3 * dfz**2) * (1 + c.QBZ4 * gz + c.QBZ5 * abs(gz)) * c.LKY / c.LMUY
    Dt = Fz * (c.QDZ1 + c.QDZ2 * dfz) * (1 + c.QDZ3 * gz + c.QDZ4 * gz**2) * R0 / Fz0 * c.LTR * (1 - c.QPZ1 * dpi)
    Et = (c.QEZ1 + c.QEZ2 * dfz + c.QEZ3 * dfz**2) * (1 + (c.QEZ4 + c.QEZ5 * gz) * 2 / pi * atan(Bt * c.QCZ1 * at))
    Dr = Fz * ((c.QDZ6 + c.QDZ7 * dfz) * c.LRES + (c.QDZ8 + c.QDZ9 * dfz) * (1 + c.QPZ2 * dpi) * gz) * R0 * c.LMUY
    Br = c.QBZ9 * c.LKY / c.LMUY + c.QBZ10 * By * Cy
    ateq, areq = (_sgn(a) * atan(sqrt(tan(a) ** 2 + (Kx / Ky * kappa) ** 2)) for a in (at, ar))
    t = Dt * cos(c.QCZ1 * atan(_bend(Bt, ateq, min(Et, 1)))) * cos(alpha)
    s = (c.SSZ1 + c.SSZ2 * Fy / Fz0 + (c.SSZ3 + c.SSZ4 * dfz) * gamma) * R0 * c.LS
    Mz = -t * (Fy - SVyk) + Dr * cos(atan(Br * areq)) * cos(alpha) + s * Fx
    Mx = R0 * Fz * (c.QSX1 * c.LVMX + (-c.QSX2 * (1 + c.QPX1 * dpi) * gamma + c.QSX3 * Fy / Fz0) * c.LMX)
    # Pacejka (2012), 4.E69 and 4.E70; Project Chrono, ChPac02Tire
    hill = (
        c.QSX4 * cos(c.QSX5 * atan((c.QSX6 * Fz / Fz0) ** 2)) * sin(c.QSX7 * gamma + c.QSX8 * atan(c.QSX9 * Fy / Fz0))
    )
    Mx += R0 * Fz * (hill + c.QSX10 * atan(c.QSX11 * Fz / Fz0) * gamma) * c.LMX
    of_camber = c.QSY5 * gamma**2 + c.QSY6 * gamma**2 * Fz / Fz0
    My = c.QSY1 + c.QSY2 * Fx / Fz0 + c.QSY3 * speed_ratio + c.QSY4 * speed_ratio**4 + of_camber
    My *= -R0 * Fz * (Fz / Fz0) ** c.QSY7 * c.LMY
    My *= (c.LIP * (1 + dpi)) ** c.QSY8
    return Fx, Fy, Mx, My, Mz


def plain_relaxation_lengths(coefficients, load, gamma):
    """The longitudinal and the lateral relaxation length."""
    c = SimpleNamespace(**coefficients)
    Fz0s = c.FNOMIN * c.LFZO
    dfz = (load - Fz0s) / Fz0s
    along = load * (c.PTX1 + c.PTX2 * dfz) * exp(-c.PTX3 * dfz) * c.UNLOADED_RADIUS / c.FNOMIN * c.LSGKP
    shape = sin(2 * atan(load / (c.PTY2 * Fz0s))) * (1 - c.PKY3 * abs(gamma * c.LGAY))
    return along, c.PTY1 * shape * c.UNLOADED_RADIUS * c.LFZO * c.LSGAL
