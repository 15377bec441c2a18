"""Events that begin and end within one step: bodies that meet and part, a stop touched and left, a bump of a law passed.

The sign of an event function at both ends of a step says nothing of its inside.  The search looks at values and rates at
the ends first, by bounds that hold for a cubic and for a convex function.  Only where these reach an edge it follows the
function along the step's interpolant, in parts that are halved until a cubic describes each of them (Shampine and
Thompson, Comput. Math. Appl. 39 (2000) 43-49, for the need; Park and Barton, ACM TOMACS 6 (1996) 137-165).

An edge of an event function is zero: the step ends where the event function passes it.  The edges of an argument part its law into zones;
to go from one zone into the next is nothing that a step's error control does not see, but a zone that the step has passed
through, or has visited between its ends, has been overlooked.  A zone is visited where its law departs from what it was before
the edge, further than the zones overlap.
"""

from __future__ import annotations

from math import floor, isfinite, sqrt

from stiffmbs.compile.machine.layout import EVENT_SEARCH
from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate

MARGIN = 0.1
"""Part of the range of a function's bounds that is added to those between the ends."""
LOOKED_AT, ALSO_AT = 0.4142135623730951, 0.7320508075688772
"""Places within a part of a step where a cubic is compared with the function: no round fractions of a period."""
FITS, NOISE = 0.02, 1e-9
"""Part of the range of its values by which the function may differ from the cubic there, and part of the largest number in the
state that rounding takes of values and rates."""
REPEATED = 8.0
"""Times that a function may miss the cubic of what its rate differs by, taken over another time: in a step of some nanoseconds
rates are rounding, and no part is short enough for them to fit."""
SHALLOW = 1e-5
"""Part of that noise which no event function is taken to go beyond zero by: rounding alone changes the sign of a contact that is just closed."""
WELL, MOST_MISSED = 0.03, 1e300
"""Part of what is allowed that the cubic must keep to for the next part of the step to be twice as long: it misses by the fourth
power; what counts for a function without a number."""
LEAST_PART, MOST_PARTS = 1e-4, 5000
DIFFERENCE = 1e-6
"""Part of a step, or of a part of one, over which rates are taken."""
REFINED, REFINEMENTS = 0.02, 5
"""Part of a part of a step over which a parabola is laid at an extremum, and how often, each over a tenth of the one before."""
BISECTIONS, BEHIND = 50, 1e-9
"""The event is put behind the change by this part of the step, so that the new law holds there."""
UNKNOWN = 8.0
"""Times that a function may be further from the cubic than where it was looked at."""
STEEP = 8.0
"""Times that a rate at an end must be larger than the change between the ends for the function to be one that turns round."""
CLEAR = 4.0
"""Times that a function must be further from zero than its change in a step to be taken for far from it."""
WIDER = 2.0
"""Times the change and the rates in a step that no bound lies further from its ends (those of `_bound` lie within 1.8 of them)."""
TURNED, HARDLY_TURNED = 1.0, 0.3
"""rad, by which a body may turn in a step without a look inside, or at rates: those at the ends tell nothing of whole turns."""

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
def _edge(w, k, number):
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
def _beyond(w, k, value, one, other, least):
    """Whether a function at a value is in a zone that is neither of two, further than it overlaps with these and than `least`."""
    here, low, high = zone(w, k, value), min(one, other), max(one, other)
    if here > high:
        return value - _edge(w, k, high) > max(least, _overlap(w, k, high))
    if here < low:
        return _edge(w, k, low - 1) - value > max(least, _overlap(w, k, low - 1))
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
def _left_out(w, k):
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
def _reaches(w, k, start, start_rate, end, end_rate, missed):
    """Whether an event function may leave its side, or another function come into a zone that is none of those at the ends of the step."""
    one, other = zone(w, k, w.value_before[k]), zone(w, k, w.value_after[k])
    if abs(one - other) > 1:
        return True
    low, high = (
        _bound(start, start_rate, end, end_rate, missed, -1),
        _bound(start, start_rate, end, end_rate, missed, 1),
    )
    if k < w.n_event_functions:
        return zone(w, k, low) != one or zone(w, k, high) != one
    return _beyond(w, k, low, one, other, 0.0) or _beyond(w, k, high, one, other, 0.0)


@compiled
def _turned(w, q_before, q_after, most):
    """Whether a body has turned by more than an angle."""
    turned = 0.0
    for k in range(w.n_angles):
        turned = max(turned, abs(q_after[w.angle[k]] - q_before[w.angle[k]]))
    return turned > most


@compiled
def clear(w, h, q_before, q_after):
    """Whether all functions are so far from zero that rates need not be looked at; rates at the end are then those of the step."""
    if w.n > w.n_event_functions or _turned(w, q_before, q_after, HARDLY_TURNED):
        return False
    for k in range(w.n):
        change = w.value_after[k] - w.value_before[k]
        nearest = min(abs(w.value_after[k]), abs(w.value_before[k]))
        if not nearest > CLEAR * (abs(change) + h * abs(w.rate_before[k])):
            return False
    for k in range(w.n):
        w.rate_after[k] = (w.value_after[k] - w.value_before[k]) / h
    return True


@compiled
def shift_ends(w):
    """The end of the last step is the start of the next."""
    noted(w.value_before, w.value_after, w.n)
    noted(w.rate_before, w.rate_after, w.n)


@compiled
def _cubic(start, start_rate, end, end_rate, x):
    """The cubic with these values and rates (times the length) at 0 and 1."""
    y = 1.0 - x
    return (y * y * (1.0 + 2.0 * x) * start + x * x * (3.0 - 2.0 * x) * end) + x * y * (y * start_rate - x * end_rate)


@compiled
def _note_zones(w):
    """Keep the edges about the values at the start of the step."""
    for k in range(w.n):
        value = w.value_before[k]
        if w.zone_low[k] < value <= w.zone_high[k]:
            continue
        number = zone(w, k, value)
        endless = w.period[k] > 0.0
        w.zone_low[k] = _edge(w, k, number - 1) if endless or number > 0 else -float("inf")
        w.zone_high[k] = (
            _edge(w, k, number) if endless or number < w.first_edge[k + 1] - w.first_edge[k] else float("inf")
        )


@compiled
def _note_apart(w, h):
    """Note how far each function stays from the edges of its zone, by bounds wider than those of `_bound`; no number above 0 where that is not known."""
    for k in range(w.n):
        start, end = w.value_before[k], w.value_after[k]
        start_rate, end_rate = h * w.rate_before[k], h * w.rate_after[k]
        missed = abs(w.m[k] - _cubic(start, start_rate, end, end_rate, LOOKED_AT))
        beyond = WIDER * (abs(end - start) + abs(start_rate) + abs(end_rate)) + UNKNOWN * missed
        below, above = min(start, end) - beyond - w.zone_low[k], w.zone_high[k] - max(start, end) - beyond
        w.apart[k] = min(below, above)


@compiled
def suspicious(w, h, q_before, q_after):
    """Whether the values and rates at both ends of a step of length h, and the values at `LOOKED_AT`, allow an event."""
    if _turned(w, q_before, q_after, TURNED):
        return True
    _note_zones(w)
    _note_apart(w, h)
    for k in range(w.n):
        if w.apart[k] > 0.0:
            continue
        start, start_rate, end, end_rate = (
            w.value_before[k],
            h * w.rate_before[k],
            w.value_after[k],
            h * w.rate_after[k],
        )
        missed = abs(w.m[k] - _cubic(start, start_rate, end, end_rate, LOOKED_AT))
        if not _left_out(w, k) and _reaches(w, k, start, start_rate, end, end_rate, missed):
            return True
    return False


@compiled
def _load_at(w, s, place):
    """The state at a place within the step, from 0 to 1, by the polynomial through the nodes (barycentric formula)."""
    total = 0.0
    for i in range(w.n_state):
        w.row[w.n_nodes * w.n_state + i] = 0.0
    state = shifted(w.row, w.n_nodes * w.n_state)
    for node in range(w.n_nodes):
        apart = place - w.node[node]
        row = shifted(w.row, node * w.n_state)
        if apart == 0.0:
            noted(state, row, w.n_state)
            total = 1.0
            break
        factor = w.weight[node] / apart
        total += factor
        for i in range(w.n_state):
            state[i] += factor * row[i]
    for i in range(s.n_q):
        s.q[i] = state[i] / total
    for i in range(s.n_u):
        s.u[i] = state[s.n_q + i] / total


@compiled
def keep_row(w, s, node):
    """Keep the state at hand as that of a node."""
    row = shifted(w.row, node * w.n_state)
    noted(row, s.q, s.n_q)
    noted(shifted(row, s.n_q), s.u, s.n_u)


@compiled
def _values(w, s, begun, h, place):
    _load_at(w, s, place)
    return evaluate(s, SWITCH, begun + place * h)


@compiled
def _mismatch(w, part, noise):
    """By how much cubics miss the functions that may have an event within a part of the step, relative to what is allowed."""
    worst = 0.0
    for k in range(w.n):
        if _left_out(w, k):
            continue
        start, start_rate, end, end_rate = w.a[k], part * w.a_rate[k], w.b[k], part * w.b_rate[k]
        first = abs(w.m[k] - _cubic(start, start_rate, end, end_rate, LOOKED_AT))
        second = abs(w.m2[k] - _cubic(start, start_rate, end, end_rate, ALSO_AT))
        if not _reaches(w, k, start, start_rate, end, end_rate, max(first, second)):
            continue
        seen = max(start, end, w.m[k], w.m2[k]) - min(start, end, w.m[k], w.m2[k])
        missed = max(first, second) / (FITS * seen + noise + w.noise[k])
        worst = max(worst, missed) if isfinite(missed) else MOST_MISSED
    return worst


@compiled
def _note_noise(w, s, begun, h, end, part):
    """Note by how much rounding alone may make functions miss their cubics: what rates over another time differ by."""
    apart = 2.0 * DIFFERENCE * part
    nearby = _values(w, s, begun, h, end - apart)
    for k in range(w.n):
        w.noise[k] = REPEATED * part * abs((w.b[k] - nearby[k]) / apart - w.b_rate[k])


@compiled
def _extremum(start, start_rate, end, end_rate, which):
    """Where within (0, 1) the cubic has a slope of zero, the first or second such place; 2 for nowhere."""
    a = 3.0 * (start_rate + end_rate - 2.0 * (end - start))
    b = 2.0 * (3.0 * (end - start) - 2.0 * start_rate - end_rate)
    inside = b * b - 4.0 * a * start_rate
    if inside < 0.0:
        return 2.0
    half = -0.5 * (b + (sqrt(inside) if b >= 0.0 else -sqrt(inside)))
    root = 2.0
    if which == 0 and a != 0.0:
        root = half / a
    if which == 1 and half != 0.0:
        root = start_rate / half
    return root if 0.0 < root < 1.0 else 2.0


@compiled
def _visits(w, k, value, low, high):
    """Note that a function has a value at a place; whether that is an event.  It was in the zone of the start up to `low`."""
    one, other = zone(w, k, w.value_before[k]), zone(w, k, w.value_after[k])
    here = zone(w, k, value)
    if here != one and w.left_high[k] < 0.0:
        w.left_low[k], w.left_high[k] = low, high
    if k < w.n_event_functions:
        return here != one and abs(value) > w.depth
    if abs(one - other) > 1:
        return here != one
    return _beyond(w, k, value, one, other, w.depth)


@compiled
def _visits_extremum(w, s, begun, h, k, low, place, part):
    """Note that a function has its extremum near a place, which parabolas bring nearer; whether that is an event."""
    apart = REFINED * part
    for _ in range(REFINEMENTS):
        here = _values(w, s, begun, h, place)[k]
        if _visits(w, k, here, low, place):
            return True
        apart = min(apart, place - low, low + part - place)
        before = _values(w, s, begun, h, place - apart)[k]
        behind = _values(w, s, begun, h, place + apart)[k]
        curved = before - 2.0 * here + behind
        if curved == 0.0 or not isfinite(curved):
            return False
        place += min(max(0.5 * apart * (before - behind) / curved, -apart), apart)
        apart *= 0.1
    return False


@compiled
def _seen_at_end(w, k):
    """Whether an event function has changed at the end of the step, which is seen without a search: it may have changed before, too."""
    return k < w.n_event_functions and zone(w, k, w.value_before[k]) != zone(w, k, w.value_after[k])


@compiled
def _first_within(w, s, begun, h, low, part):
    """The first event of all functions within a part of the step, as a place in the step; 2 for none."""
    first = 2.0
    for k in range(w.n):
        if _left_out(w, k):
            continue
        start, start_rate, end, end_rate = w.a[k], part * w.a_rate[k], w.b[k], part * w.b_rate[k]
        there = _visits(w, k, w.m[k], low, low + LOOKED_AT * part) or _visits(w, k, w.m2[k], low, low + ALSO_AT * part)
        if not there and _reaches(w, k, start, start_rate, end, end_rate, 0.0):
            for which in range(2):
                place = _extremum(start, start_rate, end, end_rate, which)
                if place < 1.0 and not there:
                    there = _visits_extremum(w, s, begun, h, k, low, low + place * part, part)
        if not there and not (low + part > 1.0 - BEHIND and _seen_at_end(w, k)):
            there = _visits(w, k, end, low, low + part)
        if there:
            place = _change(w, s, begun, h, k)
            if place < first:
                first = place
                for j in range(w.n):
                    w.found[j] = 0
                w.found[k] = 1
    return first


@compiled
def _change(w, s, begun, h, k):
    """Where a function leaves the zone in which it was at the start of the step."""
    here = zone(w, k, w.value_before[k])
    low, high = w.left_low[k], w.left_high[k]
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if zone(w, k, _values(w, s, begun, h, middle)[k]) != here:
            high = middle
        else:
            low = middle
    return high


@compiled
def _longest_part(w):
    """A half, or less where a body turns far: rates at the ends of a part must tell of its turning."""
    last = shifted(w.row, (w.n_nodes - 1) * w.n_state)
    turned = 0.0
    for k in range(w.n_angles):
        turned = max(turned, abs(last[w.angle[k]] - w.row[w.angle[k]]))
    return max(min(0.5, TURNED / max(turned, TURNED)), LEAST_PART)


@compiled
def first_event(w, s, begun, h):
    """The place, from 0 to 1, of the first event within a step from `begun` that the nodes describe; 2 for none."""
    noted(w.a, w.value_before, w.n)
    for k in range(w.n):
        w.a_rate[k] = h * w.rate_before[k]
        w.left_high[k] = -1.0
    low = 0.0
    longest = _longest_part(w)
    part = longest
    parts = 0
    noise = 0.0
    for i in range(w.n_state):
        noise = max(noise, NOISE * abs(w.row[i]))
    w.depth = SHALLOW * noise
    while low < 1.0:
        end = min(low + part, 1.0)
        part = end - low
        noted(w.b, _values(w, s, begun, h, end), w.n)
        noted_rates(w.b_rate, w.b, _values(w, s, begun, h, end - DIFFERENCE * part), -DIFFERENCE * part, w.n)
        noted(w.m, _values(w, s, begun, h, low + LOOKED_AT * part), w.n)
        noted(w.m2, _values(w, s, begun, h, low + ALSO_AT * part), w.n)
        parts += 1
        for k in range(w.n):
            w.noise[k] = 0.0
        missed = _mismatch(w, part, noise)
        if missed > 1.0:
            _note_noise(w, s, begun, h, end, part)
            missed = _mismatch(w, part, noise)
        if missed > 1.0 and part > LEAST_PART and parts < MOST_PARTS:
            part *= 0.5
            continue
        place = _first_within(w, s, begun, h, low, part)
        if place <= 1.0:
            return min(1.0, place + BEHIND)
        noted(w.a, w.b, w.n)
        noted(w.a_rate, w.b_rate, w.n)
        low = end
        part = min(2.0 * part, longest) if missed < WELL else part
    return 2.0
