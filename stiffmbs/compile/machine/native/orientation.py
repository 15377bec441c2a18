"""Shared orientation values of spatial bodies and coordinate rates, for quaternions p of any length.

A = 2/|p|^2 (p_v p_v^T + p_0 [p_v] + p_0^2) - 1 is the rotation matrix for any length of p; p' = p w / 2. Shabana,
Dynamics of Multibody Systems (2013), sec. 2.3; Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), ch. 6.
"""

from math import sqrt

from ...bodies import SPACE
from .access import compiled, shifted

N_Q, N_U, TURN_STRIDE = SPACE.n_q, SPACE.n_u, SPACE.turn_stride
"""Coordinates and velocities of a spatial body, and shared values per coordinate."""


@compiled
def share_orientation(p, turn):
    """Compute A by rows, e = 2 p/|p|^2 and n = 2/|p|^2 for kernels."""
    n = 2.0 / (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
    e0, e1, e2, e3 = n * p[0], n * p[1], n * p[2], n * p[3]
    turn[0] = e0 * p[0] + e1 * p[1] - 1.0
    turn[1] = e1 * p[2] - e0 * p[3]
    turn[2] = e1 * p[3] + e0 * p[2]
    turn[3] = e1 * p[2] + e0 * p[3]
    turn[4] = e0 * p[0] + e2 * p[2] - 1.0
    turn[5] = e2 * p[3] - e0 * p[1]
    turn[6] = e1 * p[3] - e0 * p[2]
    turn[7] = e2 * p[3] + e0 * p[1]
    turn[8] = e0 * p[0] + e3 * p[3] - 1.0
    turn[9] = e0
    turn[10] = e1
    turn[11] = e2
    turn[12] = e3
    turn[13] = n


@compiled
def _turning(p, w, followed, rate, factor):
    """Compute rate += factor p w / 2 from the components of w that p follows."""
    half = 0.5 * factor
    p0, p1, p2, p3 = p[0], p[1], p[2], p[3]
    w0, w1, w2 = followed[0] * w[0], followed[1] * w[1], followed[2] * w[2]
    rate[0] += half * (-p1 * w0 - p2 * w1 - p3 * w2)
    rate[1] += half * (p0 * w0 + p2 * w2 - p3 * w1)
    rate[2] += half * (p0 * w1 + p3 * w0 - p1 * w2)
    rate[3] += half * (p0 * w2 + p1 * w1 - p2 * w0)


@compiled
def add_rates(s, u, factor, target):
    """Compute target += factor Z(q) u."""
    if s.spatial == 0:
        for k in range(s.n_u):
            target[k] += factor * u[k]
        return
    for body in range(s.n_u // N_U):
        q, v = N_Q * body, N_U * body
        for k in range(3):
            target[q + k] += factor * u[v + k]
        w, followed = shifted(u, v + 3), shifted(s.followed, v + 3)
        _turning(shifted(s.q, q + 3), w, followed, shifted(target, q + 3), factor)


@compiled
def move(s, u, h):
    """Move all bodies for a time h at constant velocities u, and normalise the quaternions.

    p + tan(x)/x h p w/2 with x = h |w|/2, normalised, is the rotation by h w; the series of tan(x)/x ends after x^4.
    """
    if s.spatial == 0:
        add_rates(s, u, h, s.q)
        return
    for body in range(s.n_u // N_U):
        q, w, followed = shifted(s.q, N_Q * body), shifted(u, N_U * body + 3), shifted(s.followed, N_U * body + 3)
        square = 0.0
        for k in range(3):
            q[k] += h * u[N_U * body + k]
            square += (0.5 * h * followed[k] * w[k]) * (0.5 * h * followed[k] * w[k])
        _turning(shifted(q, 3), w, followed, shifted(q, 3), h * (1.0 + square * (1.0 / 3.0 + square * (2.0 / 15.0))))
    take_unit_length(s)


@compiled
def add_by_rotation(s, body, factor, row, slot, a):
    """Add factor * row Z to three slots of a, with four derivatives by a body's quaternion in `row`."""
    p, followed = shifted(s.q, N_Q * body + 3), shifted(s.followed, N_U * body + 3)
    half = 0.5 * factor
    a[slot[0]] += half * followed[0] * (p[0] * row[1] - p[1] * row[0] + p[3] * row[2] - p[2] * row[3])
    a[slot[1]] += half * followed[1] * (p[0] * row[2] - p[2] * row[0] + p[1] * row[3] - p[3] * row[1])
    a[slot[2]] += half * followed[2] * (p[0] * row[3] - p[3] * row[0] + p[2] * row[1] - p[1] * row[2])


@compiled
def take_unit_length(s):
    """Normalise the quaternions."""
    if s.spatial:
        for body in range(s.n_u // N_U):
            p = shifted(s.q, N_Q * body + 3)
            scale = 1.0 / sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
            for k in range(4):
                p[k] *= scale
