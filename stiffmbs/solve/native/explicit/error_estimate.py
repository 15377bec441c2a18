"""The error of a Runge-Kutta step, by the schemes that are embedded in it, and where these tell nothing."""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.solve.native.event_search.bounds import event_search_view, noted, zone
from stiffmbs.solve.native.explicit.stages import add_stages, load_state
from stiffmbs.solve.native.tables.views import dynamics_view

UNTRUSTED = 1e3
"""The error that a step counts for which cannot be trusted."""
UNSEEN = 1e-2
"""Estimated error, relative to how far the last stage is from the end, below which the schemes say nothing of it."""
MOST_BELOW = 100.0
"""How far below the better of two embedded schemes the estimate may be.  Two schemes tell the error of a third by the rule that
orders 3 and 5 give, which holds for smooth motion; where friction rises within a step that is off: dop853 had 137
times the tolerance where the estimate said 0.4 and the scheme of order 5 said 171."""


@compiled
def _weigh(x):
    """One over the tolerance of each number of the state, over the step that was tried."""
    for i in range(x.n):
        x.weight[i] = 1.0 / (x.atol[i] + x.rtol * max(abs(x.y_before[i]), abs(x.y[i])))


@compiled
def _squares(x, c, row):
    """The mean square of the difference to an embedded scheme, over the tolerance (without the factor h)."""
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
    """The estimated error of the step over the tolerance."""
    first = _squares(x, c, 0)
    if c.n_errors == 1:
        return h * sqrt(first)
    both = first + 0.01 * _squares(x, c, 1)
    return h * max(first / sqrt(both), sqrt(first) / MOST_BELOW) if both != 0.0 else 0.0


@compiled
def _squared(x, other):
    """The squared distance of the new state from another, in tolerances."""
    total = 0.0
    for i in range(x.n):
        ratio = (x.y[i] - other[i]) * x.weight[i]
        total += ratio * ratio
    return total


@compiled
def _sees_other_laws(x, h):
    """Whether some event function of a force is in another zone at the last stage, still in `y_stage`, than at the step's end."""
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
    """The estimated error over the tolerance, or at least `UNTRUSTED` where the stages have gone astray.

    Stages that leave a stiff contact at its far side see no force there; all differences between schemes then cancel, and
    the estimate is zero for a step that is nonsense.  The last stage, at the step's end, is then further from the end
    than the whole step is long.  Where stability holds steps back stages go as far, too: an estimate by one scheme tells it
    then, unless it is far smaller or the stage sees another law.
    """
    _weigh(x)
    error = _error_of(x, c, h)
    astray = _squared(x, x.y_stage)
    if not astray > x.n or not astray > _squared(x, x.y_before):
        return error
    unseen = c.n_errors == 2 or error * error * x.n < UNSEEN * UNSEEN * astray
    return max(error, UNTRUSTED) if unseen or _sees_other_laws(x, h) else error
