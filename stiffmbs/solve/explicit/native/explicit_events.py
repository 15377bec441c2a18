"""Event location of explicit integrators: steps end at sign changes of event functions."""

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.calls import int32
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.bounds import (
    LOOKED_AT,
    departed,
    event_search_view,
    fastest_turn,
    longest_by_turns,
    note_farthest,
    note_unresolved,
    noted_rates,
    repeats,
    shift_ends,
    suspicious,
    turned_arguments,
)
from stiffmbs.solve.events.native.from_zero import begin_sides, leave_zero, leaves_zero, note_sides
from stiffmbs.solve.events.native.nearby import note_intervals
from stiffmbs.solve.events.native.outside import note_outside
from stiffmbs.solve.events.native.parameters import BISECTIONS, EPSILON, INDISTINCT, NEXT_STEP, SEARCH
from stiffmbs.solve.events.native.values import switches, take_reactions
from stiffmbs.solve.events.native.within_step import first_event, keep_row
from stiffmbs.solve.explicit.native.attempt import arrive, attempt
from stiffmbs.solve.explicit.native.error_estimate import trusted_error
from stiffmbs.solve.explicit.native.interpolant import interpolated, prepare
from stiffmbs.solve.explicit.native.parameters import CONTROL, LOCATION
from stiffmbs.solve.explicit.native.stages import explicit_view, load_state, scheme_view, weighted

AT_ANOTHER_LAW, IN_ANOTHER_INTERVAL = range(1, 3)
"""End of a step: an event, at which integrators restart, or a breakpoint of a law, where they continue."""
RETRIED, NO_EVENT, TURNED_TOO_FAR = range(1, 4)
"""Outcomes of a search other than 0, a step to an event."""


@compiled
def _values(x, s, y, t):
    load_state(s, y)
    return switches(event_search_view(x.watch), s, t)


@compiled
def _changed(x, values):
    """Return True if an event function has changed its sign in the step."""
    w = event_search_view(x.watch)
    changed = 0
    for k in range(x.n_event_functions):
        changed += w.value_before[k] != 0.0 and departed(w, k, values[k])
    return changed > 0


@compiled
def _note_changed(x, w):
    """Note the event functions that have changed their signs at the end of the step."""
    for k in range(x.n_event_functions):
        w.found[k] = 1 if w.value_before[k] != 0.0 and departed(w, k, w.value_after[k]) else 0


@compiled
def _values_ahead(x, s, ahead):
    """Return the event functions after the initial accelerations of the step have acted for a time."""
    for i in range(x.n):
        x.difference[i] = x.y_before[i] + ahead * x.k[i]
    add_rates(s, shifted(x.k, s.n_q), 0.5 * ahead * ahead, x.difference)
    return _values(x, s, x.difference, x.t_before + ahead)


@compiled
def _note_sides_at_start(x, s):
    """Find the initial signs of functions that are zero at the start of the step and nonzero at its end."""
    w = event_search_view(x.watch)
    count = x.n_event_functions
    if not leaves_zero(w.value_before, w.value_after, count):
        return
    load_state(s, x.y_before)
    begin_sides(w.m, w.m2, count)
    ahead = max(EPSILON * x.span, INDISTINCT * abs(x.t))
    while (
        ahead <= NEXT_STEP.just_after * x.span
        and note_sides(w.value_before, _values_ahead(x, s, ahead), w.m, w.m2, count) > 0
    ):
        ahead *= SEARCH.longer


@compiled
def _note_rates(x, s, y, rates, t, ahead, value, rate):
    """Compute the rates of all event functions at a state over a time `ahead`, which may be negative."""
    w = event_search_view(x.watch)
    for i in range(x.n):
        x.difference[i] = y[i] + ahead * rates[i]
    noted_rates(rate, value, _values(x, s, x.difference, t + ahead), ahead, w.n)


@compiled
def _note_start(x, s, w, small):
    """Compute values and rates at the start of the step, unless known from the end of the previous step."""
    if not (w.ready and w.begun == x.t_before):
        copied(w.a, w.value_before, x.n_event_functions)
        copied(w.value_before, _values(x, s, x.y_before, x.t_before), w.n)
        leave_zero(w.value_before, w.a, x.n_event_functions)
        _note_rates(x, s, x.y_before, x.k, x.t_before, small, w.value_before, w.rate_before)
        w.begun = x.t_before
        w.ready = 1


@compiled
def _turned_too_far(x, s, w):
    """Return True if a sine's argument changes too much in the step; where no shorter step is allowed, note it."""
    if w.n_turns == 0:
        return False
    _note_start(x, s, w, SEARCH.difference * x.span)
    turned = turned_arguments(w, w.value_before, w.value_after)
    if turned <= 2.0 * SEARCH.turned:
        return False
    if x.span * SEARCH.turned > w.least * turned:
        return True
    note_unresolved(w, x.t_before, w.value_before, w.value_after)
    return False


@compiled
def _look_within(x, c, s):
    """Compute all event functions at `LOOKED_AT`, on the cubic through states and rates at both ends."""
    w = event_search_view(x.watch)
    h, theta = x.span, LOOKED_AT
    rest = 1.0 - theta
    begins, ends = x.k, shifted(x.k, c.stages * x.n)
    for i in range(x.n):
        straight = rest * rest * (1.0 + 2.0 * theta) * x.y_before[i] + theta * theta * (3.0 - 2.0 * theta) * x.y[i]
        x.difference[i] = straight + theta * rest * h * (rest * begins[i] - theta * ends[i])
    copied(w.m, _values(x, s, x.difference, x.t_before + theta * h), w.n)
    note_farthest(w, w.m)


@compiled
def _stages_have_changed(x, c, s, changed):
    """Return True if a stage of the step has other signs than the start and the end of the step.

    The weights of such a stage may exclude it from the error estimate.  If the step has `changed` signs and has been
    shortened, its end may be just after an event, so that stages there do not count.
    """
    for row in range(1, c.stages):
        if changed and c.c[row] >= 1.0:
            continue
        weighted(x, c, x.y_stage, row, x.span)
        if _changed(x, _values(x, s, x.y_stage, x.t_before + c.c[row] * x.span)):
            return True
    return False


@compiled
def _event_within(x, c, s, m, changed):
    """Return the time from the step's start to an event within it; 0 for none, or a negative status.

    The whole length is returned if stages show an event at an unknown time (see `_stages_have_changed`).
    `value_after` holds the values at the step's end.
    """
    w = event_search_view(x.watch)
    h = x.span
    if not h > INDISTINCT * abs(x.t):
        w.ready = 0
        return 0.0
    small = SEARCH.difference * h
    _note_start(x, s, w, small)
    _note_rates(x, s, x.y, shifted(x.k, c.stages * x.n), x.t, -small, w.value_after, w.rate_after)
    _look_within(x, c, s)
    note_intervals(w)
    if not suspicious(w, h, x.y_before, x.y):
        return 0.0
    if _stages_have_changed(x, c, s, changed):
        return h
    status = prepare(x, c, s, m)
    if status < 0:
        return float(status)
    for node in range(w.n_nodes):
        interpolated(x, c, w.node[node], x.y_stage)
        load_state(s, x.y_stage)
        take_reactions(w, s, x.t_before + w.node[node] * h)
        keep_row(w, s, node)
    event = first_event(w, s, x.t_before, h)
    return event * h if INDISTINCT * abs(x.t) < event * h < h else 0.0


@compiled
def _first_change(x, c, s, high):
    """Return the time from the step's start, up to `high`, at which the interpolant first shows a sign change."""
    low = 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        interpolated(x, c, middle / x.span, x.y_stage)
        if _changed(x, _values(x, s, x.y_stage, x.t_before + middle)):
            high = middle
        else:
            low = middle
    return high


@compiled
def retaken(x, c, s, m, h):
    """Repeat the step with another length; 0 or a negative status."""
    status = attempt(x, c, s, m, h)
    if status < 0:
        return status
    x.span = h
    x.t = x.t_before + h
    x.dense_ready = 0
    return arrive(x, c, s, m, x.t)


@compiled
def _any_found(x):
    """Return True if the event is one of an event function; those of a law's argument have no sign."""
    found = event_search_view(x.watch).found
    count = 0
    for k in range(x.n_event_functions):
        count += found[k]
    return count > 0


@compiled
def _way_past(x, c, s, least, most):
    """Return the time after which a sign change exceeds rounding, `least` or more: slow motions take longer."""
    rates = shifted(x.k, c.stages * x.n)
    ahead = least
    while ahead <= most and _any_found(x):
        for i in range(x.n):
            x.y_stage[i] = x.y[i] + ahead * rates[i]
        if _changed(x, _values(x, s, x.y_stage, x.t + ahead)):
            return ahead
        ahead *= 2.0
    return least


@compiled
def _go_past(x, c, ahead):
    """Extrapolate the end of the step beyond an event by a time in which rates stay constant."""
    rates = shifted(x.k, c.stages * x.n)
    for i in range(x.n):
        x.y[i] += ahead * rates[i]
    x.t += ahead


@compiled
def _taken_to_change(x, c, s, m, high, beyond):
    """Repeat the step until it ends just before the first sign change of an event function.

    The first estimate comes from the interpolant of a step across the event, later ones from steps that end there.
    Returns 0, a negative status, or `RETRIED`.
    """
    changed = True
    for _ in range(LOCATION.most_retaken):
        status = prepare(x, c, s, m)
        if status < 0:
            return status
        first = _first_change(x, c, s, high)
        if not changed and first <= x.span + 2.0 * beyond:
            return 0
        status = retaken(x, c, s, m, max(first - beyond, 0.5 * first))
        if status < 0:
            return status
        changed = _changed(x, _values(x, s, x.y, x.t))
        if changed:
            high = x.span
    return RETRIED if changed else 0


@compiled
def _taken_to_event(x, c, s, m, h, beyond):
    """Repeat the step up to its first event; 0, a negative status, `RETRIED`, `NO_EVENT` or `TURNED_TOO_FAR`."""
    w = event_search_view(x.watch)
    copied(w.value_after, _values(x, s, x.y, x.t), w.n)
    _note_sides_at_start(x, s)
    if _turned_too_far(x, s, w):
        return TURNED_TOO_FAR
    changed = _changed(x, w.value_after)
    if changed:
        _note_changed(x, w)
        status = _taken_to_change(x, c, s, m, h, beyond)
        if status != 0:
            return status
        h = x.span
        copied(w.value_after, _values(x, s, x.y, x.t), w.n)
    within = _event_within(x, c, s, m, changed)
    if within == 0.0:
        return 0 if changed else NO_EVENT
    if within < 0.0:
        return int(within)
    if within == h:
        return RETRIED
    if _any_found(x):
        return _taken_to_change(x, c, s, m, within, beyond)
    return retaken(x, c, s, m, max(within - beyond, 0.5 * within))


def end_at_event(explicit):
    """Repeat the last step up to its first event, if there is one; 0, a negative status, or `RETRIED`.

    `RETRIED` means that the shortened step is inaccurate and was discarded.  Only scenes with event functions need it.
    """
    x = explicit_view(explicit)
    c = scheme_view(x.scheme)
    m = dynamics_view(x.dynamics)
    return int32(_ended_at_event(x, c, state_view(m.state), m))


@compiled
def _ended_at_event(x, c, s, m):
    h = x.span
    beyond = max(LOCATION.beyond * h, INDISTINCT * abs(x.t))
    status = _taken_to_event(x, c, s, m, h, beyond)
    w = event_search_view(x.watch)
    if status == NO_EVENT:
        _note_repeats(x, w, 0)
        note_outside(w, x.t)
        note_farthest(w, w.value_after)
        shift_ends(w)
        if w.n_turns > 0:
            x.h = min(x.h, longest_by_turns(w, w.rate_before, SEARCH.turned))
        w.begun = x.t
        load_state(s, x.y)
        take_reactions(w, s, x.t)
        return 0
    if status < 0:
        return status
    if status == TURNED_TOO_FAR:
        return _gone_back(x, c, x.span * SEARCH.turned / turned_arguments(w, w.value_before, w.value_after))
    error = x.repeats * trusted_error(x, c, x.span) if status == 0 else CONTROL.untrusted
    if not error <= 1.0:
        shorter = x.span * max(CONTROL.least_factor, CONTROL.safety * error**-c.exponent)
        if shorter >= x.shortest:
            return _gone_back(x, c, shorter)
    _note_repeats(x, w, 1)
    _go_past(x, c, _way_past(x, c, s, 2.0 * beyond, max(SEARCH.difference * h, x.shortest)))
    x.at_event = IN_ANOTHER_INTERVAL if _goes_on(x, s) else AT_ANOTHER_LAW
    return 0


@compiled
def _note_repeats(x, w, events):
    """Set the factor of a step's error: the number of periods in the run if laws end a step in each.

    Errors of periods add up.  A mean change of the argument below the allowed one of a step reduces the factor in proportion.
    """
    if w.n_turns > 0:
        w.begins = min(w.begins, x.t_before)
        w.narrow += events
        turned = fastest_turn(w, w.rate_before) * (x.t - w.begins)
        x.repeats = max(1.0, min(1.0, turned / (SEARCH.turned * max(x.steps, 1))) * repeats(w, x.t, False))


@compiled
def _goes_on(x, s):
    """Return True if the next step needs no restart: an argument has passed a breakpoint without a sign change."""
    event_search_view(x.watch).ready = 0
    return not (_any_found(x) or _changed(x, _values(x, s, x.y, x.t)))


@compiled
def _gone_back(x, c, h):
    """Return to the step's start for a shorter step."""
    x.h = h
    copied(x.y, x.y_before, x.n)
    copied(shifted(x.k, c.stages * x.n), x.k, x.n)
    x.t = x.t_before
    x.rejected += 1
    x.dense_ready = 0
    return RETRIED
