"""Vectors perpendicular to a unit vector, and steps along them, in kernels."""

from __future__ import annotations

from math import sqrt

from ..native.access import compiled, shifted


@compiled
def across(n, t):
    """Compute two unit vectors perpendicular to n and to each other."""
    x, y, z = n[0], n[1], n[2]
    if abs(x) <= abs(y) and abs(x) <= abs(z):
        a, b, c = 0.0, z, -y
    elif abs(y) <= abs(z):
        a, b, c = -z, 0.0, x
    else:
        a, b, c = y, -x, 0.0
    size = 1.0 / sqrt(a * a + b * b + c * c)
    a, b, c = a * size, b * size, c * size
    t[0], t[1], t[2] = a, b, c
    size = 1.0 / sqrt(x * x + y * y + z * z)
    t[3], t[4], t[5] = (y * c - z * b) * size, (z * a - x * c) * size, (x * b - y * a) * size


@compiled
def along(v, t):
    """Return a scalar product."""
    return v[0] * t[0] + v[1] * t[1] + v[2] * t[2]


@compiled
def bent(h, s, t):
    """Return the second derivative of the support function along two vectors."""
    x = h[4] * t[0] + h[7] * t[1] + h[8] * t[2]
    y = h[7] * t[0] + h[5] * t[1] + h[9] * t[2]
    z = h[8] * t[0] + h[9] * t[1] + h[6] * t[2]
    return s[0] * x + s[1] * y + s[2] * z


@compiled
def curvature(h, t, added, k):
    """Compute k = t^T h'' t + added: two diagonal entries, then the off-diagonal one."""
    u = shifted(t, 3)
    k[0] = bent(h, t, t) + added
    k[1] = bent(h, u, u) + added
    k[2] = bent(h, t, u)


@compiled
def made_definite(k):
    """Replace a non-positive smaller eigenvalue of a symmetric matrix by its absolute value."""
    half = 0.5 * (k[0] - k[1])
    spread = sqrt(half * half + k[2] * k[2])
    least = 0.5 * (k[0] + k[1]) - spread
    floor = 1e-12 * (abs(least) + 2.0 * spread) + 1e-300
    if least >= floor:
        return
    more = max(-least, floor) - least
    x = half - spread if half < 0.0 else k[2]
    y = k[2] if half < 0.0 else -half - spread
    square = x * x + y * y
    if square > 0.0:
        k[0] += more * x * x / square
        k[1] += more * y * y / square
        k[2] += more * x * y / square
    else:
        k[0] += more
        k[1] += more


@compiled
def solved(k, g, p):
    """Compute p = k^-1 g."""
    det = k[0] * k[1] - k[2] * k[2]
    p[0] = (k[1] * g[0] - k[2] * g[1]) / det
    p[1] = (k[0] * g[1] - k[2] * g[0]) / det


@compiled
def moved(n, t, p, size, to):
    """Compute to = n + size (p_0 t_0 + p_1 t_1)."""
    for k in range(3):
        to[k] = n[k] + size * (p[0] * t[k] + p[1] * t[3 + k])


@compiled
def take_unit_length(n):
    size = 1.0 / sqrt(along(n, n))
    for k in range(3):
        n[k] *= size
