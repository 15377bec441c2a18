"""Start of explicit steps from consistent values: rates and event functions there, and the first step size."""

from math import isfinite, sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.solve.events.native.bounds import begin_bands, event_search_view
from stiffmbs.solve.events.native.from_zero import at_zero, begin_sides, keep_sides, note_sides
from stiffmbs.solve.events.native.parameters import INDISTINCT, SEARCH
from stiffmbs.solve.explicit.native.parameters import FIRST_STEP
from stiffmbs.solve.explicit.native.stages import add_trailing_rates, load_state, rates


@compiled
def start_steps(x, c, s, m):
    """Compute the rates q' at the state y in the last stage, next to its accelerations, and the event functions."""
    load_state(s, x.y)
    copied(s.lam, x.lam, s.n_c)
    k = shifted(x.k, c.stages * x.n)
    for i in range(s.n_q):
        k[i] = 0.0
    add_rates(s, s.u, 1.0, k)
    if m.n_trailing > 0:
        evaluate(s, ACCELERATION, x.t)
        add_trailing_rates(s, m, 1.0, k)
    if x.n_event_functions > 0:
        w = event_search_view(x.watch)
        copied(w.value_before, evaluate(s, SWITCH, x.t), w.n)
        begin_bands(w)
        if at_zero(w.value_before, x.n_event_functions) > 0:
            _leave_zeros(x, w, s, m, k)
    x.started = 1


@compiled
def _go_ahead(x, s, k, ahead):
    """Load the initial state extrapolated by a time at rates k; return its event functions."""
    for i in range(x.n):
        x.difference[i] = x.y[i] + ahead * k[i]
    add_rates(s, shifted(k, s.n_q), 0.5 * ahead * ahead, x.difference)
    load_state(s, x.difference)
    return evaluate(s, SWITCH, x.t + ahead)


@compiled
def _leave_zeros(x, w, s, m, k):
    """Compute rates slightly after the start if event functions are exactly zero there, where rounding decides the law.

    They are rejected if they lead back to the zero, as in sticking friction.
    """
    count, signs = x.n_event_functions, w.value_before
    later, ahead = shifted(x.k, x.n), max(x.shortest, INDISTINCT * abs(x.t))
    begin_sides(w.m, w.m2, count)
    zeros = at_zero(signs, count)
    undecided = zeros
    while undecided > 0 and 0.0 < ahead <= FIRST_STEP.farthest * x.shortest:
        undecided = note_sides(signs, _go_ahead(x, s, k, ahead), w.m, w.m2, count)
        ahead *= SEARCH.longer
    ahead /= SEARCH.longer
    if at_zero(signs, count) == zeros:
        return
    _go_ahead(x, s, k, ahead)
    if rates(x, s, m, 1, x.t + ahead) == 0 and keep_sides(signs, _go_ahead(x, s, later, ahead), count):
        copied(k, later, x.n)


@compiled
def _size(x, values):
    """Return the RMS of a vector of state variables, in tolerances."""
    total = 0.0
    for i in range(x.n):
        ratio = values[i] * x.weight[i]
        total += ratio * ratio
    return sqrt(total / max(x.n, 1))


@compiled
def first_step(x, c, s, m, end):
    """Return a first step with a small error, s (Hairer, Norsett, Wanner I, ch. II.4, "starting step size")."""
    rate = shifted(x.k, c.stages * x.n)
    for i in range(x.n):
        x.weight[i] = 1.0 / (x.atol[i] + x.rtol * abs(x.y[i]))
    of_state = _size(x, x.y)
    of_rate = _size(x, rate)
    h = (
        FIRST_STEP.part * of_state / of_rate
        if min(of_state, of_rate) > FIRST_STEP.small and isfinite(of_rate)
        else FIRST_STEP.short
    )
    for i in range(x.n):
        x.y_stage[i] = x.y[i] + h * rate[i]
    load_state(s, x.y_stage)
    if rates(x, s, m, 1, x.t + h) < 0:
        return h
    later = shifted(x.k, x.n)
    for i in range(x.n):
        x.difference[i] = later[i] - rate[i]
    largest = max(of_rate, _size(x, x.difference) / h)
    if not isfinite(largest):
        return h
    longer = (FIRST_STEP.part / largest) ** (1.0 / c.order) if largest > 0.0 else h
    return min(min(h / FIRST_STEP.part, longer), end - x.t)
