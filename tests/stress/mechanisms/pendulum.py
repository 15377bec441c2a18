"""The pendulum in closed form, and mechanisms that move like one."""

from __future__ import annotations

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc

GRAVITY = 9.81


def swing(t: np.ndarray, start: float, rate: float, speed: float = 0.0) -> np.ndarray:
    """The angle from hanging of phi'' = -rate^2 sin(phi), by Jacobi's elliptic functions.

    Parameters
    ----------
    t : ndarray
        s.
    start, speed : floats
        Angle and its rate at t = 0, rad, rad/s.
    rate : float
        Of small swings, 1/s.

    Notes
    -----
    With k = sqrt(m) the sine of half the amplitude, sin(phi/2) = k sn(u | m) while it swings (m < 1), and
    sin(phi/2) = sn(k u | 1/m) while it turns over and over (Landau, Lifshitz, Mechanics, section 11).
    """
    m = np.sin(start / 2) ** 2 + (speed / (2 * rate)) ** 2
    if m < 1:
        k = np.sqrt(m)
        quarter = np.arcsin(np.clip(np.sin(start / 2) / k, -1, 1)) if k else 0.0
        u0 = ellipkinc(quarter, m)
        u0 = u0 if speed >= 0 else 2 * ellipk(m) - u0
        return 2 * np.arcsin(k * ellipj(rate * t + u0, m)[0])
    k, way = np.sqrt(m), np.sign(speed)
    u0 = ellipkinc(start / 2, 1 / m)
    return 2 * ellipj(way * k * rate * t + u0, 1 / m)[3]


def bar_rate(length: float) -> float:
    """The rate of small swings of a uniform bar hung by its end, 1/s: sqrt(3 g / 2 L)."""
    return float(np.sqrt(1.5 * GRAVITY / length))
