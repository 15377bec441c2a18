"""The local error of a step, by two steps of half its length."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.solve.native.accumulated_errors import accumulated_errors_view, add_error
from stiffmbs.solve.native.explicit.attempt import arrive, attempt
from stiffmbs.solve.native.explicit.stages import copied

HALVED_APART = 199
"""Steps from one that is measured to the next."""


@compiled
def two_halves(x, c, s, m, h):
    """Keep where two steps of half the length lead from y_before, and leave all else as it was; 0 or a negative status."""
    start = shifted(x.halved, x.n)
    rate = shifted(x.halved, 2 * x.n)
    end = shifted(x.k, c.stages * x.n)
    t = x.t_before
    copied(start, x.y_before, x.n)
    copied(rate, x.k, x.n)
    status = attempt(x, c, s, m, 0.5 * h)
    if status == 0:
        status = arrive(x, c, s, m, t + 0.5 * h)
    if status == 0:
        x.t_before = t + 0.5 * h
        copied(x.y_before, x.y, x.n)
        copied(x.k, end, x.n)
        status = attempt(x, c, s, m, 0.5 * h)
    if status == 0:
        status = arrive(x, c, s, m, t + h)
    copied(x.halved, x.y, x.n)
    x.t_before = t
    copied(x.y_before, start, x.n)
    copied(x.y, start, x.n)
    copied(x.k, rate, x.n)
    copied(end, rate, x.n)
    return status


@compiled
def add_measured(x):
    """Add the difference between the new state and that of two halves."""
    for i in range(x.n):
        x.halved[i] = x.y[i] - x.halved[i]
    add_error(accumulated_errors_view(x.accumulated), x.y, x.halved, HALVED_APART)
