"""Rotation vectors from quaternions, in kernels."""

from math import acos, sqrt

from .access import compiled

NEAR = 0.1
"""Distance from h = 1 up to which the series is used, where the closed form loses digits."""
TERMS = 14
"""Number of terms of the series; each is at most a twentieth of its predecessor."""


@compiled
def _near_one(x, order):
    """Return the order-th derivative by h of sum a_k x^k, x = 1 - h, a_0 = 2, a_k = a_(k-1) k/(2k + 1)."""
    total = 0.0
    coefficient = 2.0
    power = 1.0
    for k in range(TERMS + order):
        if k > 0:
            coefficient *= k / (2.0 * k + 1.0)
        if k >= order:
            falling = 1.0
            for i in range(order):
                falling *= -float(k - i)
            total += coefficient * falling * power
            power *= x
    return total


@compiled
def rotation_vector(h, order):
    """Return the order-th derivative of c(h) = 2 acos(h)/sqrt(1 - h^2): rotation angle over the sine of its half.

    h is the scalar part of a unit quaternion and v its vector part; c v is the rotation vector. From (1 - h^2) c' = h c
    - 2 follows (1 - h^2) c^(n+1) = (2n + 1) h c^(n) + n^2 c^(n-1).
    """
    if 1.0 - h < NEAR:
        return _near_one(1.0 - h, order)
    h = max(h, -1.0)
    rest = 1.0 - h * h
    before = 2.0 * acos(h) / sqrt(rest)
    if order == 0:
        return before
    current = (h * before - 2.0) / rest
    for n in range(1, order):
        following = ((2 * n + 1) * h * current + n * n * before) / rest
        before = current
        current = following
    return current
