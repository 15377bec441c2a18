"""Nonsmooth functions in kernels (`stiffmbs.compile.symbolic.nonsmooth`)."""

from __future__ import annotations

from .access import compiled


@compiled
def chosen(x, below, at, above):
    """One of three by the sign of x."""
    return below if x < 0.0 else above if x > 0.0 else at


@compiled
def sign(x):
    """-1 or 1."""
    return 1.0 if x >= 0.0 else -1.0


@compiled
def magnitude(x):
    """The absolute value."""
    return x if x >= 0.0 else -x


@compiled
def greater(a, b):
    """The greater of two."""
    return a if a >= b else b


@compiled
def less(a, b):
    """The less of two."""
    return a if a <= b else b


@compiled
def inside(x, x0, x1, value):
    """A value between two bounds of x, zero at them and beyond."""
    return 0.0 if x <= x0 or x >= x1 else value


@compiled
def _level(x, x0, h0, h1, order):
    """A derivative by x of what is h0 up to x0 and h1 behind."""
    if order > 0:
        return 0.0
    return h0 if x <= x0 else h1


@compiled
def _ramp(h0, h1, width, order, shape):
    """A derivative by x of what goes from h0 to h1 within a width; `shape` is that of its course from 0 to 1 within 1."""
    if order == 0:
        return h0 + (h1 - h0) * shape
    power = 1.0
    for _ in range(order):
        power *= width
    return (h1 - h0) * shape / power


@compiled
def _cubic(z, order):
    """The order-th derivative of 3 z^2 - 2 z^3."""
    if order == 0:
        return z * z * (3.0 - 2.0 * z)
    if order == 1:
        return 6.0 * z * (1.0 - z)
    if order == 2:
        return 6.0 - 12.0 * z
    return -12.0 if order == 3 else 0.0


@compiled
def _quintic(z, order):
    """The order-th derivative of 10 z^3 - 15 z^4 + 6 z^5."""
    if order == 0:
        return z * z * z * (10.0 + z * (6.0 * z - 15.0))
    if order == 1:
        return 30.0 * z * z * (1.0 - z) * (1.0 - z)
    if order == 2:
        return 60.0 * z * (1.0 + z * (2.0 * z - 3.0))
    if order == 3:
        return 60.0 + z * (360.0 * z - 360.0)
    if order == 4:
        return 720.0 * z - 360.0
    return 720.0 if order == 5 else 0.0


@compiled
def step(x, x0, h0, x1, h1, order):
    """The order-th derivative by x of the cubic from h0 at x0 to h1 at x1, which is flat at both ends."""
    if x <= x0 or x >= x1:
        return _level(x, x0, h0, h1, order)
    return _ramp(h0, h1, x1 - x0, order, _cubic((x - x0) / (x1 - x0), order))


@compiled
def step5(x, x0, h0, x1, h1, order):
    """The same of the quintic that has no curvature at both ends either."""
    if x <= x0 or x >= x1:
        return _level(x, x0, h0, h1, order)
    return _ramp(h0, h1, x1 - x0, order, _quintic((x - x0) / (x1 - x0), order))
