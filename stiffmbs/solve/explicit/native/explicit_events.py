"""Event location of explicit integrators: steps end at sign changes of event functions."""

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.bounds import (
    changes,
    cubic,
    event_search_view,
    fastest_turn,
    note_changes,
    repeats,
    time_of_difference,
    turned_arguments,
)
from stiffmbs.solve.events.native.layouts import EVENT, NO_EVENT, PASSED_INTERVAL, RETRIED
from stiffmbs.solve.events.native.locate import go_on, located, note_rates
from stiffmbs.solve.events.native.parameters import BISECTIONS, INDISTINCT, SEARCH
from stiffmbs.solve.events.native.values import switches, take_reactions, unwrapped
from stiffmbs.solve.events.native.within_step import keep_row
from stiffmbs.solve.explicit.native.attempt import retaken
from stiffmbs.solve.explicit.native.error_estimate import trusted_error
from stiffmbs.solve.explicit.native.interpolant import interpolated, prepare
from stiffmbs.solve.explicit.native.parameters import CONTROL, LOCATION
from stiffmbs.solve.explicit.native.stages import load_state, scheme_view, weighted
from stiffmbs.solve.explicit.native.start import go_straight


@compiled
def begin_search(x, s):
    """Begin to search for events from the current state, whose values are noted and whose rates are in the last stage."""
    w = event_search_view(x.watch)
    note_rates(x, w, s, x.t, time_of_difference(w, x.h, x.t), go_straight)
    x.h = min(x.h, w.longest)


@compiled
def _load_within(x, s, ahead):
    """Load the state of the last step a time after its start; 0 or a negative status."""
    c = scheme_view(x.scheme)
    status = 0 if x.dense_ready else prepare(x, c, s, dynamics_view(x.dynamics))
    if status == 0:
        interpolated(x, c, ahead / x.span, x.y_stage)
        load_state(s, x.y_stage)
    return status


@compiled
def _load_roughly(x, s, ahead):
    """Load the state of the last step a time after its start, on the cubic through states and rates at both ends."""
    begins, ends = x.k, shifted(x.k, scheme_view(x.scheme).stages * x.n)
    for i in range(x.n):
        x.difference[i] = cubic(x.y_before[i], x.span * begins[i], x.y[i], x.span * ends[i], ahead / x.span)
    load_state(s, x.difference)
    return 0


@compiled
def _has_changed(x, w, s, ahead):
    """Return True if the interpolant of the last step shows a sign change a time after its start."""
    _load_within(x, s, ahead)
    return changes(w, switches(w, s, x.t_before + ahead)) > 0


@compiled
def _taken_to_change(x, c, s, m, first, most, beyond):
    """Repeat the step until it ends just before the first sign change of an event function; 0, a negative status, or `RETRIED`.

    The estimate `first` comes from the interpolant of a step of length `most` across the event, later ones from steps that end
    nearby.
    """
    w = event_search_view(x.watch)
    for _ in range(LOCATION.most_retaken):
        status = retaken(x, c, s, m, max(first - beyond, 0.5 * first))
        if status == 0:
            status = prepare(x, c, s, m)
        if status < 0:
            return status
        load_state(s, x.y)
        changed = changes(w, switches(w, s, x.t))
        low, high = 0.0, x.span
        if not changed:
            high += 2.0 * beyond
            while high < most and not _has_changed(x, w, s, high):
                low = high
                high = x.span + SEARCH.longer * (high - x.span)
            if low == 0.0 or high >= most:
                return 0
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if _has_changed(x, w, s, middle):
                high = middle
            else:
                low = middle
        first = high
    return RETRIED if changed else 0


@compiled
def _signs_change(w):
    """Return True if the event is one of an event function; those of a law's argument have no sign."""
    count = 0
    for k in range(w.n_event_functions):
        count += w.found[k]
    return count > 0


@compiled
def _are_stages_beyond(x, c, s, w):
    """Return True if stages of a step that ends at an event are beyond it, by more than the tolerance of the function's change.

    They have forces of the other side, which the error estimate hardly sees: the stages are far less accurate than the end.
    """
    for k in range(w.n_event_functions):
        w.m[k] = abs(w.value_before[k])
        w.m2[k] = 0.0
    for row in range(1, c.stages):
        weighted(x, c, x.y_stage, row, x.span)
        load_state(s, x.y_stage)
        values = unwrapped(w, evaluate(s, SWITCH, x.t_before + c.c[row] * x.span))
        for k in range(w.n_event_functions):
            if values[k] * w.value_before[k] < 0.0:
                w.m2[k] = max(w.m2[k], abs(values[k]))
            else:
                w.m[k] = max(w.m[k], abs(values[k]))
    beyond = 0
    for k in range(w.n_event_functions):
        beyond += w.m2[k] > x.rtol * w.m[k]
    return beyond > 0


@compiled
def _way_past(x, w, s, least, most):
    """Return the time after which a sign change exceeds rounding, `least` or more: slow motions take longer."""
    ahead = least
    while ahead <= most and _signs_change(w):
        go_straight(x, s, ahead)
        if changes(w, switches(w, s, x.t + ahead)):
            return ahead
        ahead *= 2.0
    return least


@compiled
def ended_at_event(x, c, s, m):
    """Repeat the last step up to its first event; `NO_EVENT`, `EVENT`, `PASSED_INTERVAL`, `RETRIED` or a negative status."""
    w = event_search_view(x.watch)
    h = x.span
    beyond = max(LOCATION.beyond * h, INDISTINCT * abs(x.t))
    load_state(s, x.y)
    copied(w.value_after, switches(w, s, x.t), w.n)
    turned = turned_arguments(w, w.value_before, w.value_after)
    if turned > 2.0 * SEARCH.turned and h * SEARCH.turned > w.least * turned:
        return _gone_back(x, c, h * SEARCH.turned / turned)
    place = located(x, w, s, x.t, go_straight, _load_roughly, _load_within)
    if place < 0.0:
        return int(place)
    if place > 1.0 or not (_signs_change(w) or place * h > INDISTINCT * abs(x.t)):
        _note_repeats(x, w, 0)
        load_state(s, x.y)
        go_on(w, s, x.t)
        x.h = min(x.h, w.longest)
        take_reactions(w, s, x.t)
        return NO_EVENT
    if _signs_change(w):
        status = _taken_to_change(x, c, s, m, place * h, h, beyond)
    else:
        status = retaken(x, c, s, m, max(place * h - beyond, 0.5 * place * h))
    if status < 0:
        return status
    if _signs_change(w) and 0.5 * x.span >= x.shortest and _are_stages_beyond(x, c, s, w):
        return _gone_back(x, c, 0.5 * x.span)
    error = x.repeats * trusted_error(x, c, x.span) if status == 0 else CONTROL.untrusted
    if not error <= 1.0:
        shorter = x.span * max(CONTROL.least_factor, CONTROL.safety * error**-c.exponent)
        if shorter >= x.shortest:
            return _gone_back(x, c, shorter)
    _note_repeats(x, w, 1)
    return _gone_past(x, w, s, _way_past(x, w, s, 2.0 * beyond, max(SEARCH.difference * h, x.shortest)))


@compiled
def _gone_past(x, w, s, ahead):
    """Extrapolate the end of the step beyond an event by a time, and begin to search there."""
    go_straight(x, s, ahead)
    copied(x.y, x.difference, x.n)
    x.t += ahead
    values = switches(w, s, x.t)
    note_changes(w, values)
    copied(w.value_before, values, w.n)
    keep_row(w, s, 0)
    begin_search(x, s)
    return EVENT if _signs_change(w) else PASSED_INTERVAL


@compiled
def _note_repeats(x, w, events):
    """Set the factor of a step's error: the number of periods in the run if laws end a step in each.

    Errors of periods add up.  A mean change of the argument below the allowed one of a step reduces the factor in proportion.
    """
    if w.n_turns > 0:
        w.narrow += events
        turned = fastest_turn(w, w.rate_before) * (x.t - w.begins)
        x.repeats = max(1.0, min(1.0, turned / (SEARCH.turned * max(x.steps, 1))) * repeats(w, x.t, False))


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
