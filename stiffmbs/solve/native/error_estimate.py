"""The error of a Runge-Kutta step, by the schemes that are embedded in it."""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.native.access import compiled, shifted
from stiffmbs.solve.native.stages import add_stages


@compiled
def _squares(x, c, row):
    """The mean square of the difference to an embedded scheme, over the tolerance (without the factor h)."""
    for i in range(x.n):
        x.difference[i] = 0.0
    add_stages(x, x.difference, shifted(c.errors, row * c.extended), c.stages + 1, 1.0)
    total = 0.0
    for i in range(x.n):
        scale = x.atol[i] + x.rtol[0] * max(abs(x.y_before[i]), abs(x.y[i]))
        ratio = x.difference[i] / scale
        total += ratio * ratio
    return total / x.n


@compiled
def error_of(x, c, h):
    """The estimated error of the step over the tolerance."""
    first = _squares(x, c, 0)
    if c.n_errors == 1:
        return h * sqrt(first)
    both = first + 0.01 * _squares(x, c, 1)
    return h * first / sqrt(both) if both != 0.0 else 0.0
