"""Test for possible events within a step, by values and rates at its ends.

The bounds hold for a cubic and for a convex function.  The breakpoints of an argument divide its law into intervals,
which overlap if the law continues smoothly from one into the next.
"""

from math import floor, isfinite, sqrt, tau

from stiffmbs.compile.machine.native.access import compiled, view_of
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.events.native.layouts import EVENT_SEARCH
from stiffmbs.solve.events.native.parameters import INDISTINCT, SEARCH
from stiffmbs.solve.events.native.signs_at_zero import JUST_BEYOND
from stiffmbs.solve.events.native.step_bound import STRETCHED

LOOKED_AT, ALSO_AT = 1.0 / (1.0 + sqrt(2.0)), sqrt(3.0) - 1.0
"""Places in a part of a step at which a function is compared with a cubic; no simple fractions of a period."""


event_search_view = view_of("EventSearch", EVENT_SEARCH)


@compiled
def interval(w, k, value):
    """Return the number of breakpoints of event function k below a value."""
    first, end = w.first_breakpoint[k], w.first_breakpoint[k + 1]
    turns = 0
    if w.period[k] > 0.0:
        around = floor((value - w.breakpoints[first]) / w.period[k])
        if not abs(around) < 1e15:
            return 0
        turns = int(around)
        value -= around * w.period[k]
    low = first
    high = end
    while low < high:
        middle = (low + high) // 2
        if w.breakpoints[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low - first + turns * (end - first)


@compiled
def breakpoint_of(w, k, number):
    """Return the breakpoint between the intervals `number` and `number` + 1 of function k, or the first or last one."""
    first, count = w.first_breakpoint[k], w.first_breakpoint[k + 1] - w.first_breakpoint[k]
    if w.period[k] > 0.0:
        turns = number // count
        return w.breakpoints[first + number - turns * count] + turns * w.period[k]
    return w.breakpoints[first + min(max(number, 0), count - 1)]


@compiled
def overlap(w, k, number):
    """Return the overlap of the adjacent intervals `number` and `number` + 1 of function k."""
    first, count = w.first_breakpoint[k], w.first_breakpoint[k + 1] - w.first_breakpoint[k]
    return w.overlap[first + (number % count if w.period[k] > 0.0 else min(max(number, 0), count - 1))]


@compiled
def beyond(w, k, value, one, other, least):
    """Return True if a value is outside two intervals of a function by more than their overlap and `least`."""
    here, low, high = interval(w, k, value), min(one, other), max(one, other)
    if here > high:
        return value - breakpoint_of(w, k, high) > max(least, overlap(w, k, high))
    if here < low:
        return breakpoint_of(w, k, low - 1) - value > max(least, overlap(w, k, low - 1))
    return False


@compiled
def departed(w, k, value):
    """Return True if function k has left its interval at the start of the step; one that was zero may return to zero."""
    before = w.value_before[k]
    if value == 0.0 and k < w.n_event_functions and w.band[k] == 0.0:
        return abs(before) > JUST_BEYOND
    return interval(w, k, value) != interval(w, k, before)


@compiled
def lands(w, k):
    """Return True if the breakpoints of function k end steps: those of a table with a kink may."""
    return w.at_kinks != 0 and w.kinked[k] != 0


@compiled
def noted_rates(rate, value, nearby, ahead, count):
    """Compute rates from values and from those at a time later by `ahead`."""
    for k in range(count):
        rate[k] = (nearby[k] - value[k]) / ahead


@compiled
def time_of_difference(w, h, t):
    """Return the time over which rates at t, the end of a step of length h, are computed."""
    return max(SEARCH.difference * h, SEARCH.least_difference * w.duration, INDISTINCT * abs(t))


@compiled
def watch_for(w, k, band):
    """Make event function k pass an event where it leaves a band about zero; at zero if `band` is 0."""
    first = w.first_breakpoint[k]
    w.band[k] = band
    w.breakpoints[first] = -band
    w.breakpoints[first + 1] = band if band > 0.0 else float("inf")
    w.interval_low[k] = 0.0
    w.interval_high[k] = 0.0  # unknown


@compiled
def begin_bands(w):
    """Begin with the values of the event functions at a start; end the bands of those that have left them."""
    for k in range(w.n_event_functions):
        w.farthest[k] = abs(w.value_before[k])
        if w.farthest[k] > w.band[k] > 0.0:
            watch_for(w, k, 0.0)


@compiled
def note_farthest(w, values):
    """Update the largest value of each event function from the start up to its event."""
    for k in range(w.n_event_functions):
        if not departed(w, k, values[k]):
            w.farthest[k] = max(w.farthest[k], abs(values[k]))


@compiled
def left_out(w, k):
    """Return True if a function is ignored: it is not finite, or zero at the start."""
    if not isfinite(w.value_before[k] - w.value_after[k]):
        return True
    return k < w.n_event_functions and w.band[k] == 0.0 and w.value_before[k] == 0.0


@compiled
def changes(w, values):
    """Return the number of event functions that have left their intervals at the start of the step."""
    count = 0
    for k in range(w.n_event_functions):
        count += departed(w, k, values[k]) and not left_out(w, k)
    return count


@compiled
def note_changes(w, values):
    """Mark the event functions that have left their intervals at the start of the step; return their number."""
    count = 0
    for k in range(w.n_event_functions):
        if departed(w, k, values[k]) and not left_out(w, k):
            w.found[k] = 1
            count += 1
    return count


@compiled
def _bound(start, start_rate, end, end_rate, missed, side):
    """Return a lower (`side` -1) or upper (1) bound of a function with these values and rates times the length.

    It covers the cubic's Bezier points and the intersection of the tangents, beyond which no convex function extends.
    If rates contradict the change between the ends, the function has extrema, and may extend to either side.  So may
    a function that deviates by `missed` from the cubic between the ends.
    """
    p, q = start + start_rate / 3.0, end - end_rate / 3.0
    low, high = min(p, q), max(p, q)
    if start_rate * end_rate < 0.0:
        place = (end - end_rate - start) / (start_rate - end_rate)
        if 0.0 < place < 1.0:
            meeting = start + start_rate * place
            low, high = min(low, meeting), max(high, meeting)
    steepest = max(abs(start_rate), abs(end_rate))
    if steepest > SEARCH.steep * abs(end - start):
        low, high = min(low, start, end) - 0.5 * steepest, max(high, start, end) + 0.5 * steepest
    margin = SEARCH.margin * (max(high, start, end) - min(low, start, end)) + SEARCH.unknown * missed
    return min(low - margin, start, end) if side < 0 else max(high + margin, start, end)


@compiled
def reaches(w, k, start, start_rate, end, end_rate, missed):
    """Return True if an event function may change sign, or another one leave the intervals at the ends of the step."""
    one, other = interval(w, k, w.value_before[k]), interval(w, k, w.value_after[k])
    if abs(one - other) > 1 or (lands(w, k) and beyond(w, k, w.value_after[k], one, one, 0.0)):
        return True
    if k < w.n_event_functions and departed(w, k, w.value_after[k]):
        return True
    low, high = (
        _bound(start, start_rate, end, end_rate, missed, -1),
        _bound(start, start_rate, end, end_rate, missed, 1),
    )
    if k < w.n_event_functions:
        return interval(w, k, low) != one or interval(w, k, high) != one
    return beyond(w, k, low, one, other, 0.0) or beyond(w, k, high, one, other, 0.0)


@compiled
def turned(w, q_before, q_after, most):
    """Return True if a body, or the argument of a sine, has rotated by more than `most`."""
    if w.n_with_intervals == 0:
        return False
    farthest = turned_arguments(w, w.value_before, w.value_after)
    for k in range(w.n_angles):
        farthest = max(farthest, abs(q_after[w.angle[k]] - q_before[w.angle[k]]))
    return farthest > most


@compiled
def turned_argument(w, i, change):
    """Return the size of a change of an argument of a sine, rad, without the jumps of a direction's angle."""
    if w.radians[i] < 0.0:
        return abs(change - tau * floor(change / tau + 0.5))
    return w.radians[i] * abs(change)


@compiled
def turned_arguments(w, before, after):
    """Return the largest change of an argument of a sine, rad."""
    farthest = 0.0
    for i in range(w.n_turns):
        farthest = max(farthest, turned_argument(w, i, after[w.turn[i]] - before[w.turn[i]]))
    return farthest


@compiled
def longest_by_turns(w, rate, most):
    """Return the longest step that changes no argument of a sine by more than `most`; infinite if too short."""
    fastest = fastest_turn(w, rate)
    longest = most / fastest if fastest > 0.0 else float("inf")
    return longest if longest > w.least else float("inf")


@compiled
def fastest_turn(w, rate):
    """Return the largest rate of an argument of a sine, rad/s."""
    fastest = 0.0
    for i in range(w.n_turns):
        fastest = max(fastest, abs(w.radians[i] * rate[w.turn[i]]))
    return fastest


@compiled
def repeats(w, t, passing):
    """Return the number of periods of the fastest law in the run, if its features limit a step in each; else 1.

    Errors in equal features add up, so each must be smaller by this factor.  The same holds while `passing` a feature.
    """
    fastest = fastest_turn(w, w.rate_before)
    each_turn = w.narrow > 0 and w.narrow * tau >= fastest * (t - w.begins)
    if not (passing or each_turn):
        return 1.0
    return max(1.0, fastest * w.duration / tau)


@compiled
def bounded_by_feature(w):
    """Return True if a feature limits the next step of IDA more than arguments of sines do."""
    return w.longest * fastest_turn(w, w.rate_before) * STRETCHED < SEARCH.turned  # not by rounding


@compiled
def note_unresolved(w, t, before, after):
    """Count steps with too large changes of sines' arguments; note the time and the fastest argument of the first."""
    if w.unresolved == 0:
        farthest = turned_arguments(w, before, after)
        for i in range(w.n_turns):
            if turned_argument(w, i, after[w.turn[i]] - before[w.turn[i]]) == farthest:
                w.fastest = w.turn[i]
        w.first_unresolved = t
    w.unresolved += 1


@compiled
def shift_ends(w):
    """Make the end of the last step the start of the next."""
    copied(w.value_before, w.value_after, w.n)
    copied(w.rate_before, w.rate_after, w.n)


@compiled
def cubic(start, start_rate, end, end_rate, x):
    """Return the cubic at x with these values and rates (times the length) at 0 and 1."""
    y = 1.0 - x
    return (y * y * (1.0 + 2.0 * x) * start + x * x * (3.0 - 2.0 * x) * end) + x * y * (y * start_rate - x * end_rate)


@compiled
def _note_apart(w, h):
    """Note the distance of each function from the breakpoints by bounds wider than `_bound`; 0 or less if unknown."""
    for k in range(w.n):
        if not w.near[w.call[k]]:
            continue
        start, end = w.value_before[k], w.value_after[k]
        start_rate, end_rate = h * w.rate_before[k], h * w.rate_after[k]
        missed = abs(w.m[k] - cubic(start, start_rate, end, end_rate, LOOKED_AT))
        beyond = abs(end - start) + abs(start_rate) + abs(end_rate) + SEARCH.unknown * missed
        below, above = min(start, end) - beyond - w.interval_low[k], w.interval_high[k] - max(start, end) - beyond
        w.apart[k] = min(below, above)


@compiled
def suspicious(w, h, q_before, q_after):
    """Return True if values and rates at both ends of a step of length h, and values at `LOOKED_AT`, allow an event.

    `note_intervals` has noted the intervals at its start, and the kernels with a function near a breakpoint.
    """
    if turned(w, q_before, q_after, SEARCH.turned):
        return True
    _note_apart(w, h)
    for k in range(w.n):
        if not w.near[w.call[k]] or w.apart[k] > 0.0:
            continue
        start, start_rate, end, end_rate = (
            w.value_before[k],
            h * w.rate_before[k],
            w.value_after[k],
            h * w.rate_after[k],
        )
        missed = abs(w.m[k] - cubic(start, start_rate, end, end_rate, LOOKED_AT))
        if not left_out(w, k) and reaches(w, k, start, start_rate, end, end_rate, missed):
            return True
    return False
