"""Error estimate of a Runge-Kutta step by embedded schemes, with detection of invalid estimates."""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.solve.native.event_search.bounds import event_search_view, noted, zone
from stiffmbs.solve.native.explicit.stages import add_stages, load_state
from stiffmbs.solve.native.tables.views import dynamics_view

UNTRUSTED = 1e3
"""Error assigned to a step with an invalid estimate."""
UNSEEN = 1e-2
"""Estimated error relative to the distance of the last stage from the end, below which the estimate is invalid."""
MOST_BELOW = 100.0
"""Largest ratio of the better embedded error to the estimate: the formula of orders 3 and 5 assumes smooth motion."""


@compiled
def _weigh(x):
    """Compute the inverse tolerance of each state variable for the attempted step."""
    for i in range(x.n):
        x.weight[i] = 1.0 / (x.atol[i] + x.rtol * max(abs(x.y_before[i]), abs(x.y[i])))


@compiled
def _squares(x, c, row):
    """Return the mean square of the difference to an embedded scheme in tolerances, without the factor h."""
    for i in range(x.n):
        x.difference[i] = 0.0
    add_stages(x, x.difference, shifted(c.errors, row * c.extended), c.stages + 1, 1.0)
    total = 0.0
    for i in range(x.n):
        ratio = x.difference[i] * x.weight[i]
        total += ratio * ratio
    return total / x.n


@compiled
def _error_of(x, c, h):
    """Return the estimated error of the step in tolerances."""
    first = _squares(x, c, 0)
    if c.n_errors == 1:
        return h * sqrt(first)
    both = first + 0.01 * _squares(x, c, 1)
    return h * max(first / sqrt(both), sqrt(first) / MOST_BELOW) if both != 0.0 else 0.0


@compiled
def _squared(x, other):
    """Return the squared distance of the new state from another one, in tolerances."""
    total = 0.0
    for i in range(x.n):
        ratio = (x.y[i] - other[i]) * x.weight[i]
        total += ratio * ratio
    return total


@compiled
def _sees_other_laws(x, h):
    """Return True if an event function is in another interval at the last stage (`y_stage`) than at the step's end."""
    s = state_view(dynamics_view(x.dynamics).state)
    w = event_search_view(x.watch)
    if w.n == 0:
        return False
    t = x.t_before + h
    load_state(s, x.y_stage)
    noted(w.m, evaluate(s, SWITCH, t), w.n)
    load_state(s, x.y)
    at_end = evaluate(s, SWITCH, t)
    others = 0
    for k in range(w.n):
        if zone(w, k, w.m[k]) != zone(w, k, at_end[k]):
            others += 1
    return others > 0


@compiled
def trusted_error(x, c, h):
    """Return the estimated error in tolerances, at least `UNTRUSTED` if the estimate is invalid.

    Stages beyond a stiff contact have no contact force: the differences between schemes cancel, and the estimate is
    zero.  The last stage, at the step's end, is then further from the end than the whole step is long.  The same occurs
    where stability limits steps: the estimate of a single scheme is then valid, unless far smaller or of another law.
    """
    _weigh(x)
    error = _error_of(x, c, h)
    astray = _squared(x, x.y_stage)
    if not astray > x.n or not astray > _squared(x, x.y_before):
        return error
    unseen = c.n_errors == 2 or error * error * x.n < UNSEEN * UNSEEN * astray
    return max(error, UNTRUSTED) if unseen or _sees_other_laws(x, h) else error
