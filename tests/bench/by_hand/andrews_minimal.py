"""Andrews' squeezing mechanism in its seven angles: index 1, six closures and their multipliers solved with the masses.

Test Set for IVP Solvers; Hairer and Wanner, Solving Ordinary Differential Equations II (1996), ch. VII.7.
"""

from __future__ import annotations

import numpy as np

from .loop import fast

BETA, THETA, GAMMA, PHI = -0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885
DELTA, OMEGA, EPSILON = 0.487364979543842550, -0.222668390165885885, 1.23054744454982119
MASS = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
INERTIA = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
XA, YA, XB, YB, XC, YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
C0, L0, MOM = 4530.0, 0.07785, 0.033
D, DA, E, EA, RR, RA = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
SS, SA, SB, SC, SD = 0.035, 0.01874, 0.01043, 0.018, 0.02
TA, TB, U, UA, UB, ZF, ZT, FA = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421


@fast
def minimal(t, y):
    """Rates of (beta Theta gamma Phi delta Omega epsilon) and of their velocities."""
    be, th, ga, ph, de, om, ep = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    bep, thp, gap, php, dep, omp, epp = y[7], y[8], y[9], y[10], y[11], y[12], y[13]
    m1, m2, m3, m4, m5, m6, m7 = MASS
    i1, i2, i3, i4, i5, i6, i7 = INERTIA
    e, z = E - EA, ZF - FA
    A, b = np.zeros((13, 13)), np.zeros(13)
    A[0, 0] = m1 * RA**2 + m2 * (RR**2 - 2 * DA * RR * np.cos(th) + DA**2) + i1 + i2
    A[1, 0] = A[0, 1] = m2 * (DA**2 - DA * RR * np.cos(th)) + i2
    A[1, 1] = m2 * DA**2 + i2
    A[2, 2] = m3 * (SA**2 + SB**2) + i3
    A[3, 3] = m4 * e**2 + i4
    A[4, 3] = A[3, 4] = m4 * (e**2 + ZT * e * np.sin(ph)) + i4
    A[4, 4] = m4 * (ZT**2 + 2 * ZT * e * np.sin(ph) + e**2) + m5 * (TA**2 + TB**2) + i4 + i5
    A[5, 5] = m6 * z**2 + i6
    A[6, 5] = A[5, 6] = m6 * (z**2 - U * z * np.sin(om)) + i6
    A[6, 6] = m6 * (z**2 - 2 * U * z * np.sin(om) + U**2) + m7 * (UA**2 + UB**2) + i6 + i7
    xd, yd = SD * np.cos(ga) + SC * np.sin(ga) + XB, SD * np.sin(ga) - SC * np.cos(ga) + YB
    length = np.hypot(xd - XC, yd - YC)
    force = -C0 * (length - L0) / length
    fx, fy = force * (xd - XC), force * (yd - YC)
    b[0] = MOM - m2 * DA * RR * thp * (thp + 2 * bep) * np.sin(th)
    b[1] = m2 * DA * RR * bep**2 * np.sin(th)
    b[2] = fx * (SC * np.cos(ga) - SD * np.sin(ga)) + fy * (SD * np.cos(ga) + SC * np.sin(ga))
    b[3] = m4 * ZT * e * dep**2 * np.cos(ph)
    b[4] = -m4 * ZT * e * php * (php + 2 * dep) * np.cos(ph)
    b[5] = -m6 * U * z * epp**2 * np.cos(om)
    b[6] = m6 * U * z * omp * (omp + 2 * epp) * np.cos(om)
    sbt, cbt = np.sin(be + th), np.cos(be + th)
    for row in (7, 9, 11):
        A[row, 0], A[row, 1] = -RR * np.sin(be) + D * sbt, D * sbt
        A[row + 1, 0], A[row + 1, 1] = RR * np.cos(be) - D * cbt, -D * cbt
    A[7, 2], A[8, 2] = -SS * np.cos(ga), -SS * np.sin(ga)
    spd, cpd, soe, coe = np.sin(ph + de), np.cos(ph + de), np.sin(om + ep), np.cos(om + ep)
    A[9, 3], A[9, 4] = -E * cpd, -E * cpd + ZT * np.sin(de)
    A[10, 3], A[10, 4] = -E * spd, -E * spd - ZT * np.cos(de)
    A[11, 5], A[11, 6] = ZF * soe, ZF * soe - U * np.cos(ep)
    A[12, 5], A[12, 6] = -ZF * coe, -ZF * coe - U * np.sin(ep)
    for row in range(7, 13):
        for column in range(7):
            A[column, row] = A[row, column]
    px = RR * np.cos(be) * bep**2 - D * cbt * (bep + thp) ** 2
    py = RR * np.sin(be) * bep**2 - D * sbt * (bep + thp) ** 2
    b[7], b[8] = px - SS * np.sin(ga) * gap**2, py + SS * np.cos(ga) * gap**2
    b[9] = px - E * spd * (php + dep) ** 2 - ZT * np.cos(de) * dep**2
    b[10] = py + E * cpd * (php + dep) ** 2 - ZT * np.sin(de) * dep**2
    b[11] = px - ZF * coe * (omp + epp) ** 2 - U * np.sin(ep) * epp**2
    b[12] = py - ZF * soe * (omp + epp) ** 2 + U * np.cos(ep) * epp**2
    rates = np.empty(14)
    rates[:7] = y[7:]
    rates[7:] = np.linalg.solve(A, b)[:7]
    return rates


def start() -> np.ndarray:
    """The published pose, at rest."""
    return np.array([BETA, THETA, GAMMA, PHI, DELTA, OMEGA, EPSILON, *np.zeros(7)])


def places(y: np.ndarray) -> np.ndarray:
    """Coordinates of the bodies, rows of (x1 y1 phi1 .. x7 y7 phi7), from rows of angles."""
    be, th, ga, ph, de, om, ep = y[:, :7].T
    c, s = np.cos, np.sin
    columns = [
        RA * c(be), RA * s(be), be,
        RR * c(be) - DA * c(be + th), RR * s(be) - DA * s(be + th), be + th,
        XB + SA * s(ga) + SB * c(ga), YB - SA * c(ga) + SB * s(ga), ga,
        XA + ZT * c(de) + (E - EA) * s(ph + de), YA + ZT * s(de) - (E - EA) * c(ph + de), ph + de,
        XA + TA * c(de) - TB * s(de), YA + TA * s(de) + TB * c(de), de,
        XA + U * s(ep) + (ZF - FA) * c(om + ep), YA - U * c(ep) + (ZF - FA) * s(om + ep), om + ep,
        XA + UA * s(ep) - UB * c(ep), YA - UA * c(ep) - UB * s(ep), ep,
    ]  # fmt: skip
    return np.stack(columns, axis=1)
