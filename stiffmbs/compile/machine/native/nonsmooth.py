"""Functions with corners in kernels (`stiffmbs.compile.symbolic.nonsmooth`)."""

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
def step(x, x0, h0, x1, h1, order):
    """The order-th derivative by x of the cubic from h0 at x0 to h1 at x1, which is flat at both ends."""
    if x <= x0:
        return h0 if order == 0 else 0.0
    if x >= x1:
        return h1 if order == 0 else 0.0
    width = x1 - x0
    rise = h1 - h0
    z = (x - x0) / width
    if order == 0:
        return h0 + rise * (z * z * (3.0 - 2.0 * z))
    if order == 1:
        return rise * (6.0 * z * (1.0 - z)) / width
    if order == 2:
        return rise * (6.0 - 12.0 * z) / (width * width)
    return -12.0 * rise / (width * width * width) if order == 3 else 0.0


@compiled
def step5(x, x0, h0, x1, h1, order):
    """The same of the quintic that has no curvature at both ends either."""
    if x <= x0:
        return h0 if order == 0 else 0.0
    if x >= x1:
        return h1 if order == 0 else 0.0
    width = x1 - x0
    rise = h1 - h0
    z = (x - x0) / width
    if order == 0:
        return h0 + rise * (z * z * z * (10.0 + z * (6.0 * z - 15.0)))
    if order == 1:
        return rise * (30.0 * z * z * (1.0 - z) * (1.0 - z)) / width
    if order == 2:
        return rise * (60.0 * z * (1.0 + z * (2.0 * z - 3.0))) / (width * width)
    if order == 3:
        return rise * (60.0 + z * (360.0 * z - 360.0)) / (width * width * width)
    if order == 4:
        return rise * (720.0 * z - 360.0) / (width * width * width * width)
    return 720.0 * rise / (width * width * width * width * width) if order == 5 else 0.0
