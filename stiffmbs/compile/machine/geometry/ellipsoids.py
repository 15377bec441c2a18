"""Solids as Minkowski sums of ellipsoids, in kernels: support functions and their derivatives.

Each solid is the sum of up to three concentric ellipsoids; its support function is h(n) = sum sqrt(n^T M n). A pose is
an array in the axes of the second solid: d, the matrix R with the axes of the first solid as columns, and the squared
semi-axes of the three ellipsoids of each solid along its axes. A missing ellipsoid has zeros.
"""

from __future__ import annotations

from math import sqrt

from ..native.access import compiled, room, shifted

TURN = 3
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
