"""Nonsmooth functions and continuous angles in kernels (`stiffmbs.compile.symbolic`)."""

from math import atan2, cos, sin

from .access import compiled


@compiled
def chosen(x, below, at, above):
    """Return one of three values by the sign of x."""
    return below if x < 0.0 else above if x > 0.0 else at


@compiled
def sign(x):
    """Return -1 or 1; 1 at zero."""
    return 1.0 if x >= 0.0 else -1.0


@compiled
def magnitude(x):
    """Return the absolute value."""
    return x if x >= 0.0 else -x


@compiled
def greater(a, b):
    """Return the greater of two numbers."""
    return a if a >= b else b


@compiled
def less(a, b):
    """Return the smaller of two numbers."""
    return a if a <= b else b


@compiled
def inside(x, x0, x1, value):
    """Return a value for x between two bounds; zero elsewhere."""
    return 0.0 if x <= x0 or x >= x1 else value


@compiled
def _level(x, x0, h0, h1, order):
    """Return a derivative by x of the function that is h0 up to x0 and h1 beyond."""
    if order > 0:
        return 0.0
    return h0 if x <= x0 else h1


@compiled
def _ramp(h0, h1, width, order, shape):
    """Return a derivative by x of a transition from h0 to h1; `shape` is that of the unit transition from 0 to 1."""
    if order == 0:
        return h0 + (h1 - h0) * shape
    power = 1.0
    for _ in range(order):
        power *= width
    return (h1 - h0) * shape / power


@compiled
def _cubic(z, order):
    """Return the order-th derivative of 3 z^2 - 2 z^3."""
    if order == 0:
        return z * z * (3.0 - 2.0 * z)
    if order == 1:
        return 6.0 * z * (1.0 - z)
    if order == 2:
        return 6.0 - 12.0 * z
    return -12.0 if order == 3 else 0.0


@compiled
def _quintic(z, order):
    """Return the order-th derivative of 10 z^3 - 15 z^4 + 6 z^5."""
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
    """Return the order-th derivative by x of the cubic from h0 at x0 to h1 at x1 with zero end slopes."""
    if x <= x0 or x >= x1:
        return _level(x, x0, h0, h1, order)
    return _ramp(h0, h1, x1 - x0, order, _cubic((x - x0) / (x1 - x0), order))


@compiled
def step5(x, x0, h0, x1, h1, order):
    """Return the order-th derivative by x of the quintic with zero end slopes and curvatures."""
    if x <= x0 or x >= x1:
        return _level(x, x0, h0, h1, order)
    return _ramp(h0, h1, x1 - x0, order, _quintic((x - x0) / (x1 - x0), order))


@compiled
def continuous_angle(sine, cosine, counted):
    """Return the angle with a given sine and cosine that is nearest to `counted`."""
    c, s = cos(counted), sin(counted)
    return counted + atan2(sine * c - cosine * s, cosine * c + sine * s)
