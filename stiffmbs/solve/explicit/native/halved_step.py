"""Local error of a step by two steps of half its length."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.error_control.native.accumulated_errors import accumulated_errors_view, note_damping, note_error
from stiffmbs.solve.error_control.native.parameters import ACCUMULATION
from stiffmbs.solve.explicit.native.attempt import arrive, attempt
from stiffmbs.solve.explicit.native.stages import load_state, rates


@compiled
def is_halved(x):
    """Return True if the error of the next step is estimated."""
    return x.steps % ACCUMULATION.halved_apart == ACCUMULATION.halved_apart // 2


@compiled
def _look_at_damping(x, s, m, t):
    """Note the damping at the start of a step, by accelerations in the second stage; 0 or a negative status."""
    for i in range(x.n):
        x.halved[i] = x.y_before[i] * (1.0 + ACCUMULATION.faster) if i >= x.n_q else x.y_before[i]
    load_state(s, x.halved)
    status = rates(x, s, m, 1, t)
    if status == 0:
        note_damping(accumulated_errors_view(x.accumulated), x.y_before, x.k, shifted(x.k, x.n), ACCUMULATION.faster)
    return status


@compiled
def two_halves(x, c, s, m, h):
    """Store the result of two half steps from y_before, and restore everything else; 0 or a negative status."""
    start = shifted(x.halved, x.n)
    rate = shifted(x.halved, 2 * x.n)
    end = shifted(x.k, c.stages * x.n)
    t = x.t_before
    copied(start, x.y_before, x.n)
    copied(rate, x.k, x.n)
    status = _look_at_damping(x, s, m, t)
    if status == 0:
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
def note_difference(x):
    """Note the difference between the new state and that of two halves as the error of the step."""
    for i in range(x.n):
        x.halved[i] = x.y[i] - x.halved[i]
    note_error(accumulated_errors_view(x.accumulated), x.y, x.halved)
