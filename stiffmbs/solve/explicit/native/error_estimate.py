"""Error estimate of a Runge-Kutta step by embedded schemes, with detection of invalid estimates."""

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.bounds import event_search_view, interval
from stiffmbs.solve.events.native.values import unwrapped
from stiffmbs.solve.explicit.native.parameters import CONTROL
from stiffmbs.solve.explicit.native.stages import add_stages, load_state


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
    first = _squares(x, c, 0)
    if c.n_errors == 1:
        return h * sqrt(first)
    both = first + 0.01 * _squares(x, c, 1)
    return h * max(first / sqrt(both), sqrt(first) / CONTROL.astray) if both != 0.0 else 0.0


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
    copied(w.m, unwrapped(w, evaluate(s, SWITCH, t)), w.n)
    load_state(s, x.y)
    at_end = unwrapped(w, evaluate(s, SWITCH, t))
    others = 0
    for k in range(w.n):
        if interval(w, k, w.m[k]) != interval(w, k, at_end[k]):
            others += 1
    return others > 0


@compiled
def trusted_error(x, c, h):
    """Return the estimated error in tolerances, at least that of an untrusted step if the estimate is invalid.

    Stages beyond a stiff contact have no contact force: the differences between schemes cancel, and the estimate is
    zero.  The last stage, at the step's end, is then further from the end than the whole step is long.  The same occurs
    where stability limits steps: the estimate of a single scheme is then valid, unless far smaller or of another law.
    """
    _weigh(x)
    error = _error_of(x, c, h)
    astray = _squared(x, x.y_stage)
    if not astray > x.n or not astray > _squared(x, x.y_before):
        return error
    unseen = c.n_errors == 2 or error * error * x.n * CONTROL.astray * CONTROL.astray < astray
    return max(error, CONTROL.untrusted) if unseen or _sees_other_laws(x, h) else error
