"""Whether an event may begin and end within a step, by values and rates at its ends: bounds that hold for a cubic and for a
convex function, and zones of laws.

The edges of an argument part its law into zones, which overlap where the law goes on smoothly from one into the next.
"""

from __future__ import annotations

from math import floor, isfinite

from stiffmbs.compile.machine.native.access import compiled, view_of
from stiffmbs.solve.native.tables.steps import EVENT_SEARCH

MARGIN = 0.1
"""Part of the range of a function's bounds that is added to those between the ends."""
LOOKED_AT, ALSO_AT = 0.4142135623730951, 0.7320508075688772
"""Places within a part of a step where a cubic is compared with the function: no round fractions of a period."""
UNKNOWN = 8.0
"""Times that a function may be further from the cubic than where it was looked at."""
STEEP = 8.0
"""Times that a rate at an end must be larger than the change between the ends for the function to be one that turns round."""
WIDER = 2.0
"""Times the change and the rates in a step that no bound lies further from its ends (those of `_bound` lie within 1.8 of them)."""
TURNED = 1.0
"""rad, by which a body or the argument of a sine may turn in a step without a look inside: rates at the ends tell nothing of whole turns."""

BOUNDED = 0.99
"""Part of the longest step by turns below which a feature bounds the step; what is left is rounding."""
WHOLE_TURN = 6.283185307179586
"""rad, by which the argument of a sine must not turn unseen."""

event_search_view = view_of("EventSearch", EVENT_SEARCH)


@compiled
def zone(w, k, value):
    """The number of edges of event function k below a value."""
    first, end = w.first_edge[k], w.first_edge[k + 1]
    turns = 0
    if w.period[k] > 0.0:
        around = floor((value - w.edges[first]) / w.period[k])
        if not abs(around) < 1e15:
            return 0
        turns = int(around)
        value -= around * w.period[k]
    low = first
    high = end
    while low < high:
        middle = (low + high) // 2
        if w.edges[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low - first + turns * (end - first)


@compiled
def edge(w, k, number):
    """The edge between the zones `number` and `number` + 1 of function k; the first or last one beyond those there are."""
    first, count = w.first_edge[k], w.first_edge[k + 1] - w.first_edge[k]
    if w.period[k] > 0.0:
        turns = number // count
        return w.edges[first + number - turns * count] + turns * w.period[k]
    return w.edges[first + min(max(number, 0), count - 1)]


@compiled
def _overlap(w, k, number):
    """How far the zones `number` and `number` + 1 of function k, one beside the other, overlap."""
    first, count = w.first_edge[k], w.first_edge[k + 1] - w.first_edge[k]
    return w.overlap[first + (number % count if w.period[k] > 0.0 else min(max(number, 0), count - 1))]


@compiled
def beyond(w, k, value, one, other, least):
    """Whether a function at a value is in a zone that is neither of two, further than it overlaps with these and than `least`."""
    here, low, high = zone(w, k, value), min(one, other), max(one, other)
    if here > high:
        return value - edge(w, k, high) > max(least, _overlap(w, k, high))
    if here < low:
        return edge(w, k, low - 1) - value > max(least, _overlap(w, k, low - 1))
    return False


@compiled
def noted(target, values, count):
    """Keep the values of all event functions."""
    for k in range(count):
        target[k] = values[k]


@compiled
def noted_rates(rate, value, nearby, ahead, count):
    """Rates from values and from those at another instant, so much later."""
    for k in range(count):
        rate[k] = (nearby[k] - value[k]) / ahead


@compiled
def left_out(w, k):
    """Whether a function is not looked at: it is masked, or has no number."""
    if not isfinite(w.value_before[k] - w.value_after[k]):
        return True
    return k < w.n_event_functions and (w.masked[k] > 0 or w.value_before[k] == 0.0)


@compiled
def _bound(start, start_rate, end, end_rate, missed, side):
    """A bound from below (`side` -1) or above (1) on what has these values and rates (times the length) at the ends of a part.

    That of the cubic's Bezier points, and of the tangents' meeting point, beyond which no convex function goes.  Rates that
    the change between the ends does not show belong to a function that turns round, maybe often: it may go either way.  So may
    one that is `missed` by the cubic between the ends.
    """
    p, q = start + start_rate / 3.0, end - end_rate / 3.0
    low, high = min(p, q), max(p, q)
    if start_rate * end_rate < 0.0:
        place = (end - end_rate - start) / (start_rate - end_rate)
        if 0.0 < place < 1.0:
            meeting = start + start_rate * place
            low, high = min(low, meeting), max(high, meeting)
    steepest = max(abs(start_rate), abs(end_rate))
    if steepest > STEEP * abs(end - start):
        low, high = min(low, start, end) - 0.5 * steepest, max(high, start, end) + 0.5 * steepest
    margin = MARGIN * (max(high, start, end) - min(low, start, end)) + UNKNOWN * missed
    return min(low - margin, start, end) if side < 0 else max(high + margin, start, end)


@compiled
def reaches(w, k, start, start_rate, end, end_rate, missed):
    """Whether an event function may leave its side, or another function come into a zone that is none of those at the ends of the step."""
    one, other = zone(w, k, w.value_before[k]), zone(w, k, w.value_after[k])
    if abs(one - other) > 1 or (w.lands[k] and beyond(w, k, w.value_after[k], one, one, 0.0)):
        return True
    low, high = (
        _bound(start, start_rate, end, end_rate, missed, -1),
        _bound(start, start_rate, end, end_rate, missed, 1),
    )
    if k < w.n_event_functions:
        return zone(w, k, low) != one or zone(w, k, high) != one
    return beyond(w, k, low, one, other, 0.0) or beyond(w, k, high, one, other, 0.0)


@compiled
def turned(w, q_before, q_after, most):
    """Whether a body, or the argument of a sine, has turned by more than an angle."""
    if w.n_zoned == 0:
        return False
    farthest = turned_arguments(w, w.value_before, w.value_after)
    for k in range(w.n_angles):
        farthest = max(farthest, abs(q_after[w.angle[k]] - q_before[w.angle[k]]))
    return farthest > most


@compiled
def turned_arguments(w, before, after):
    """The largest change of an argument of a sine, rad."""
    farthest = 0.0
    for i in range(w.n_turns):
        farthest = max(farthest, w.radians[i] * abs(after[w.turn[i]] - before[w.turn[i]]))
    return farthest


@compiled
def longest_by_turns(w, rate, most):
    """The longest step in which no argument of a sine turns by more than an angle; infinite where that would take too many steps."""
    fastest = fastest_turn(w, rate)
    longest = most / fastest if fastest > 0.0 else float("inf")
    return longest if longest > w.least else float("inf")


@compiled
def fastest_turn(w, rate):
    """The largest rate of an argument of a sine, rad/s."""
    fastest = 0.0
    for i in range(w.n_turns):
        fastest = max(fastest, w.radians[i] * abs(rate[w.turn[i]]))
    return fastest


@compiled
def repeats(w, t, passing):
    """Return how often the fastest law that repeats does so in the run, where features of laws bound a step in each turn; else 1.

    Errors in equal features have the same sign and add up, so each must be so much smaller than the tolerance.  Also while `passing` a feature.
    """
    fastest = fastest_turn(w, w.rate_before)
    each_turn = w.narrow > 0 and w.narrow * WHOLE_TURN >= fastest * (t - w.begins)
    if not (passing or each_turn):
        return 1.0
    return max(1.0, fastest * w.duration / WHOLE_TURN)


@compiled
def bounded_by_feature(w):
    """Return True if a feature bounds the next step of IDA more than arguments of sines do."""
    return w.longest * fastest_turn(w, w.rate_before) < BOUNDED * TURNED


@compiled
def note_unresolved(w, t, before, after):
    """Note that arguments of sines turned too far in a step, and which one turned farthest in the first such step."""
    if w.unresolved == 0:
        farthest = turned_arguments(w, before, after)
        for i in range(w.n_turns):
            if w.radians[i] * abs(after[w.turn[i]] - before[w.turn[i]]) == farthest:
                w.fastest = w.turn[i]
        w.first_unresolved = t
    w.unresolved += 1


@compiled
def shift_ends(w):
    """The end of the last step is the start of the next."""
    noted(w.value_before, w.value_after, w.n)
    noted(w.rate_before, w.rate_after, w.n)


@compiled
def cubic(start, start_rate, end, end_rate, x):
    """The cubic with these values and rates (times the length) at 0 and 1."""
    y = 1.0 - x
    return (y * y * (1.0 + 2.0 * x) * start + x * x * (3.0 - 2.0 * x) * end) + x * y * (y * start_rate - x * end_rate)


@compiled
def _note_apart(w, h):
    """Note how far each function stays from the edges of its zone, by bounds wider than those of `_bound`; no number above 0 where that is not known."""
    for k in range(w.n):
        if not w.near[w.call[k]]:
            continue
        start, end = w.value_before[k], w.value_after[k]
        start_rate, end_rate = h * w.rate_before[k], h * w.rate_after[k]
        missed = abs(w.m[k] - cubic(start, start_rate, end, end_rate, LOOKED_AT))
        beyond = WIDER * (abs(end - start) + abs(start_rate) + abs(end_rate)) + UNKNOWN * missed
        below, above = min(start, end) - beyond - w.zone_low[k], w.zone_high[k] - max(start, end) - beyond
        w.apart[k] = min(below, above)


@compiled
def suspicious(w, h, q_before, q_after):
    """Whether the values and rates at both ends of a step of length h, and the values at `LOOKED_AT`, allow an event.

    The zones at its start are noted (`note_zones`), and which kernels have a function near their edges.
    """
    if turned(w, q_before, q_after, TURNED):
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
