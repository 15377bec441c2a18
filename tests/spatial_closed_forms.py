"""Motions of single rigid bodies in closed form: elliptic functions and quadratures, no integration in time.

Euler angles are zxz: precession about the ground's z, nutation (from z to the body's z), spin about the body's z.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc, gamma

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def accumulated(rate, t, panel):
    """Integral of a smooth function of time from 0 to each of the times t.

    Parameters
    ----------
    rate : function of an array of times.
    t : (n,) rising times from 0 (s).
    panel : length over which a polynomial of degree 31 stands for the function to rounding (s).
    """
    count = max(1, int(np.ceil(np.max(np.diff(t)) / panel)))
    edges = np.concatenate([np.linspace(a, b, count, endpoint=False) for a, b in itertools.pairwise(t)])
    half = np.repeat(np.diff(t), count) / count / 2
    parts = (rate(edges[:, None] + half[:, None] * (1 + NODES)) @ WEIGHTS * half).reshape(-1, count).sum(axis=1)
    return np.concatenate([[0.0], np.cumsum(parts)])


def zxz(precession, nutation, spin):
    """Rotation matrices (n, 3, 3) from Euler angles zxz."""
    (cp, sp), (cn, sn), (cs, ss) = ((np.cos(a), np.sin(a)) for a in (precession, nutation, spin))
    one, zero = np.ones_like(cp), np.zeros_like(cp)
    turns = [
        [[cp, -sp, zero], [sp, cp, zero], [zero, zero, one]],
        [[one, zero, zero], [zero, cn, -sn], [zero, sn, cn]],
        [[cs, -ss, zero], [ss, cs, zero], [zero, zero, one]],
    ]
    a, b, c = (np.moveaxis(np.array(turn), (0, 1), (-2, -1)) for turn in turns)
    return a @ b @ c


def matrices(q):
    """Rotation matrices (n, 3, 3) from unit quaternions (4, n), scalar first."""
    w, x, y, z = q
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def symmetric_top(t, *, transverse, axial, weight, nutation, precession_rate, spin):
    """Heavy symmetric top about a fixed point, let go where its nutation rests.

    Its height u = cos(nutation) obeys u'^2 = a cubic in u, which Jacobi's sn solves; precession and spin are
    quadratures (Goldstein, Classical Mechanics, ch. 5.7; Whittaker, Analytical Dynamics, section 71).

    Parameters
    ----------
    t : (n,) times from 0 (s).
    transverse, axial : moments of inertia about the fixed point, across and along the axis (kg m^2).
    weight : mass * gravity * distance of the centre of mass from the fixed point (N m).
    nutation : at the start (rad); above pi/2 it hangs.
    precession_rate : at the start (rad/s). Zero: a cusp.
    spin : component of the angular velocity along the axis, which is constant (rad/s).

    Returns
    -------
    nutation, precession, spin angle : (n,) each (rad).

    Notes
    -----
    With spin = 0 it is the spherical pendulum.
    """
    u0 = np.cos(nutation)
    b = axial * spin / transverse
    a = precession_rate * (1 - u0**2) + b * u0
    pull = 2 * weight / transverse
    energy = pull * u0 + (a - b * u0) ** 2 / (1 - u0**2)
    # pull u^3 - (energy + b^2) u^2 + (2 a b - pull) u + energy - a^2, without its root u0
    p = pull * u0 - energy - b**2
    r = 2 * a * b - pull + p * u0
    above = (-p + np.sqrt(p**2 - 4 * pull * r)) / (2 * pull)
    other = r / (pull * above)
    low, high = min(u0, other), max(u0, other)
    speed, m = np.sqrt(pull * (above - low)) / 2, (high - low) / (above - low)
    start = 0.0 if u0 == low else ellipk(m)

    def height(t):
        return low + (high - low) * ellipj(start + speed * t, m)[0] ** 2

    def precessing(t):
        return (a - b * height(t)) / (1 - height(t) ** 2)

    u, panel = height(t), ellipk(m) / speed / 8
    angle = 2 * np.arctan2(np.sqrt(1 - u), np.sqrt(1 + u))
    spinning = accumulated(lambda t: spin - precessing(t) * height(t), t, panel)
    return angle, accumulated(precessing, t, panel), spinning


def free_rates(t, inertia, omega):
    """Angular velocity (n, 3) in principal axes of a torque-free body, by Jacobi's functions.

    Landau and Lifshitz, Mechanics, section 37, for any start off the separatrix. `inertia` rises; both orders of
    the axes obey the same formulas, so the one in which the third component keeps its sign is taken.
    """
    J, w = np.array(inertia, float), np.array(omega, float)
    if J[2] * (J[2] - J[1]) * w[2] ** 2 < J[0] * (J[1] - J[0]) * w[0] ** 2:
        return free_rates_about_third(t, J[::-1], w[::-1])[:, ::-1]
    return free_rates_about_third(t, J, w)


def free_rates_about_third(t, J, w):
    """`free_rates` where 2 T J[1] lies on the side of L^2 on which the third component never vanishes."""
    below = J[0] * (J[2] - J[0]) * w[0] ** 2 + J[1] * (J[2] - J[1]) * w[1] ** 2  # 2 T J3 - L^2
    above = J[1] * (J[1] - J[0]) * w[1] ** 2 + J[2] * (J[2] - J[0]) * w[2] ** 2  # L^2 - 2 T J1
    size = np.sqrt([below / (J[0] * (J[2] - J[0])), below / (J[1] * (J[2] - J[1])), above / (J[2] * (J[2] - J[0]))])
    m = (J[1] - J[0]) * below / ((J[2] - J[1]) * above)
    speed = np.sqrt((J[2] - J[1]) * above / (J[0] * J[1] * J[2]))
    sense = np.sign(w[2])
    start = ellipkinc(np.arctan2(sense * w[1] / size[1], w[0] / size[0]), m)
    sn, cn, dn, _ = ellipj(start + speed * np.asarray(t), m)
    return np.stack([size[0] * cn, sense * size[1] * sn, sense * size[2] * dn], axis=-1)


def free_body(t, inertia, omega):
    """Angular velocity in body axes (n, 3) and rotation matrices (n, 3, 3), from the identity, without torque.

    The body sees the constant angular momentum turn: that gives two of the Euler angles about it; the third is a
    quadrature (Landau and Lifshitz, Mechanics, section 37).
    """
    J = np.array(inertia, float)

    def precessing(t):
        w = free_rates(t.ravel(), J, omega).reshape(*t.shape, 3)
        return (
            momentum
            * (J[0] * w[..., 0] ** 2 + J[1] * w[..., 1] ** 2)
            / ((J[0] * w[..., 0]) ** 2 + (J[1] * w[..., 1]) ** 2)
        )

    w = free_rates(t, J, omega)
    momentum = np.linalg.norm(J * np.array(omega))
    l1, l2, l3 = (J * w / momentum).T
    panel = 0.5 / np.linalg.norm(omega)
    turn = zxz(accumulated(precessing, t, panel), np.arccos(l3), np.arctan2(l1, l2))
    return w, turn[0].T @ turn


def steady_rolling(*, radius, mass, transverse, axial, nutation, precession_rate, gravity=9.81):
    """Spin of a disc that rolls in a circle at a constant tilt, and the radius of its centre's circle.

    Routh, Advanced Rigid Dynamics, section 244. The spin is the whole angular velocity along the axis.
    """
    s, c = np.sin(nutation), np.cos(nutation)
    gyration = transverse * precession_rate**2 * s * c - mass * gravity * radius * c
    spin = gyration / ((axial + mass * radius**2) * precession_rate * s)
    return spin, abs(radius * spin / precession_rate)


def screw_fall(t, *, pitch, mass, inertia, gravity=9.81):
    """Place along a vertical frictionless screw of a nut let go at rest (m): it falls and turns."""
    return -gravity * t**2 / 2 / (1 + inertia * (2 * np.pi / pitch) ** 2 / mass)


def hertz_impact(*, mass, speed, stiffness):
    """Deepest penetration and duration of an elastic impact with the force stiffness * depth^1.5, without weight.

    Johnson, Contact Mechanics, section 11.4.
    """
    depth = (5 * mass * speed**2 / (4 * stiffness)) ** 0.4
    return depth, 0.8 * np.sqrt(np.pi) * gamma(0.4) / gamma(0.9) * depth / speed
