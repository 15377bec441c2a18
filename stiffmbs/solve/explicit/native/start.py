"""Start of explicit steps from consistent values: rates and event functions there, and the first step size."""

from math import isfinite, sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.solve.events.native.bounds import event_search_view
from stiffmbs.solve.events.native.locate import note_values
from stiffmbs.solve.events.native.parameters import INDISTINCT, SEARCH
from stiffmbs.solve.events.native.signs_at_zero import at_zero, find_signs, keep_signs
from stiffmbs.solve.events.native.values import switches
from stiffmbs.solve.explicit.native.parameters import FIRST_STEP
from stiffmbs.solve.explicit.native.stages import add_trailing_rates, load_state, rates, scheme_view


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
    w = event_search_view(x.watch)
    if w.n > 0:
        note_values(w, s, x.t)
        if at_zero(w.value_before, w.n_event_functions) > 0:
            _leave_zeros(x, c, w, s, m)
    x.started = 1


@compiled
def go_straight(x, s, ahead):
    """Load the end of the last step, moved by a time at the rates in the last stage."""
    rate = shifted(x.k, scheme_view(x.scheme).stages * x.n)
    for i in range(x.n):
        x.difference[i] = x.y[i] + ahead * rate[i]
    load_state(s, x.difference)


@compiled
def _go_ahead(x, s, ahead):
    """Load the initial state, moved by a time with its accelerations."""
    go_straight(x, s, ahead)
    add_rates(s, shifted(x.k, scheme_view(x.scheme).stages * x.n + s.n_q), 0.5 * ahead * ahead, s.q)


@compiled
def _leave_zeros(x, c, w, s, m):
    """Compute rates slightly after the start if event functions are exactly zero there, where rounding decides the law.

    They are rejected if they lead back to the zero, as in sticking friction.
    """
    zeros = at_zero(w.value_before, w.n_event_functions)
    first, most = max(x.shortest, INDISTINCT * abs(x.t)), SEARCH.least_difference * w.duration
    ahead = find_signs(x, w, s, x.t, first, most, _go_ahead)
    if at_zero(w.value_before, w.n_event_functions) == zeros:
        return
    k = shifted(x.k, c.stages * x.n)
    copied(x.k, k, x.n)
    _go_ahead(x, s, ahead)
    found = rates(x, s, m, c.stages, x.t + ahead) == 0
    _go_ahead(x, s, ahead)
    if not (found and keep_signs(w.value_before, switches(w, s, x.t + ahead), w.n_event_functions)):
        copied(k, x.k, x.n)


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
    go_straight(x, s, h)
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
