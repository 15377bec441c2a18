"""Solids as Minkowski sums of ellipsoids, in kernels: support functions and their derivatives.

Each solid is the sum of up to three concentric ellipsoids; its support function is h(n) = sum sqrt(n^T M n). A pose is
an array in the axes of the second solid: d, the matrix R with the axes of the first solid as columns, and the squared
semi-axes of the three ellipsoids of each solid along its axes. A missing ellipsoid has zeros.
"""

from math import sqrt
from typing import Final

from ..native.access import compiled, room, shifted

TURN: Final = 3
SQUARES = TURN + 9
POSE = SQUARES + 18
"""Offsets of R and of the squares in a pose, and its length."""
CORE = 0.5
"""Thickness removed from a solid to form its core, relative to half its smallest dimension."""


@compiled
def ellipsoids(pose, fat, thinner, m):
    """Compute the matrices G with M = G^T G: semi-axes times axes by rows.

    The solids are thinned by the fraction `thinner` towards their cores. Each semi-axis is at least `fat` times the
    largest of its ellipsoid.
    """
    for term in range(6):
        squares = shifted(pose, SQUARES + 3 * term)
        core = thinner * CORE * least(shifted(pose, SQUARES if term < 3 else SQUARES + 9)) if thinner > 0.0 else 0.0
        largest = thinned(max(squares[0], max(squares[1], squares[2])), core)
        for row in range(3):
            size = max(thinned(squares[row], core), fat * largest)
            for c in range(3):
                if term < 3:
                    m[9 * term + 3 * row + c] = size * pose[TURN + 3 * c + row]
                else:
                    m[9 * term + 3 * row + c] = size if c == row else 0.0


@compiled
def thinned(square, core):
    """Return a thinned semi-axis; edges, far thinner than half the smallest dimension, are unchanged."""
    size = sqrt(square)
    return size - core if size > core else size


@compiled
def least(squares):
    """Return half the smallest dimension of a solid: the smallest semi-axis, or smallest maximum over ellipsoids."""
    if squares[3] == 0.0:
        return sqrt(min(squares[0], min(squares[1], squares[2])))
    least = max(squares[0], max(squares[1], squares[2]))
    for term in range(1, 3):
        largest = max(squares[3 * term], max(squares[3 * term + 1], squares[3 * term + 2]))
        if largest > 0.0:
            least = min(least, largest)
    return sqrt(least)


@compiled
def thinnest(pose):
    """Return the smallest ratio of semi-axes of an ellipsoid."""
    ratio = 1.0
    for term in range(6):
        at = SQUARES + 3 * term
        largest = max(pose[at], max(pose[at + 1], pose[at + 2]))
        least = min(pose[at], min(pose[at + 1], pose[at + 2]))
        if largest > 0.0:
            ratio = min(ratio, sqrt(least / largest))
    return ratio


@compiled
def times(g, n, w):
    """Compute w = G n and return its length."""
    for row in range(3):
        w[row] = g[3 * row] * n[0] + g[3 * row + 1] * n[1] + g[3 * row + 2] * n[2]
    return sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])


@compiled
def reach(m, n):
    """Return h(n)."""
    w = room(3)
    total = 0.0
    for term in range(6):
        total += times(shifted(m, 9 * term), n, w)
    return total


@compiled
def support(m, n, h):
    """Compute h[0] = h(n), its gradient h[1:4], and its second derivatives h[4:10]: xx, yy, zz, xy, xz, yz.

    With s = |G n| and w = G n/s the gradient is G^T w; the second derivative is Q^T Q/s with Q = G - w (G^T w)^T.
    """
    w = room(3)
    for k in range(10):
        h[k] = 0.0
    for term in range(6):
        g = shifted(m, 9 * term)
        s = times(g, n, w)
        if s > 0.0:
            inverse = 1.0 / s
            for row in range(3):
                w[row] *= inverse
            x = g[0] * w[0] + g[3] * w[1] + g[6] * w[2]
            y = g[1] * w[0] + g[4] * w[1] + g[7] * w[2]
            z = g[2] * w[0] + g[5] * w[1] + g[8] * w[2]
            h[0] += s
            h[1] += x
            h[2] += y
            h[3] += z
            for row in range(3):
                part = w[row]
                a, b, c = g[3 * row] - part * x, g[3 * row + 1] - part * y, g[3 * row + 2] - part * z
                p, q, r = a * inverse, b * inverse, c * inverse
                h[4] += a * p
                h[5] += b * q
                h[6] += c * r
                h[7] += a * q
                h[8] += a * r
                h[9] += b * r


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
    """Divide a vector by its length."""
    size = 1.0 / sqrt(along(n, n))
    for k in range(3):
        n[k] *= size
