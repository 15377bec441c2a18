"""Vectors of three numbers, 3x3 matrices by rows, and rows of numbers."""

from stiffmbs.compile.machine.native.access import compiled


@compiled
def cross(a, b, c):
    """Compute c = a x b."""
    c[0] = a[1] * b[2] - a[2] * b[1]
    c[1] = a[2] * b[0] - a[0] * b[2]
    c[2] = a[0] * b[1] - a[1] * b[0]


@compiled
def times(M, x, y):
    """Compute y = M x."""
    for i in range(3):
        y[i] = M[3 * i] * x[0] + M[3 * i + 1] * x[1] + M[3 * i + 2] * x[2]


@compiled
def transposed_times(M, x, y):
    """Compute y = M^T x."""
    for i in range(3):
        y[i] = M[i] * x[0] + M[3 + i] * x[1] + M[6 + i] * x[2]


@compiled
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def clear(n, to):
    """Set n numbers to zero."""
    for i in range(n):
        to[i] = 0.0


@compiled
def add_times(n, s, a, b):
    """Add s a to b, for n numbers."""
    for i in range(n):
        b[i] += s * a[i]
