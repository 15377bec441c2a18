"""Search for events within one step, such as a short contact or a passed feature of a law.

The signs of an event function at both ends of a step do not determine its values inside.  The search first checks
values and rates at the ends, by bounds for a cubic and for a convex function.  Only if these include a breakpoint, it
follows the function along the step's interpolant, in parts that are bisected until a cubic fits (Shampine and Thompson,
Comput. Math. Appl. 39 (2000) 43-49; Park and Barton, ACM TOMACS 6 (1996) 137-165).

The breakpoint of an event function is zero: the step ends there.  The breakpoints of an argument divide its law into
intervals.  Error control covers a transition from one interval into the next.  A missed event is an interval that the
step has passed, or has visited between its ends, by more than the overlap of the intervals.
"""

from math import isfinite, sqrt, tau

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.events.native.bounds import (
    ALSO_AT,
    LOOKED_AT,
    beyond,
    cubic,
    departed,
    fastest_turn,
    interval,
    lands,
    left_out,
    note_unresolved,
    noted_rates,
    reaches,
    turned_argument,
    turned_arguments,
)
from stiffmbs.solve.events.native.parameters import BISECTIONS, INDISTINCT, SEARCH
from stiffmbs.solve.events.native.values import switches, unwrapped

INFINITE = float("inf")


@compiled
def _load_at(w, s, place):
    """Load the state at a place from 0 to 1 within the step, by the interpolant of the nodes (barycentric formula)."""
    total = 0.0
    width = w.n_state + w.n_lam
    for i in range(width):
        w.row[w.n_nodes * width + i] = 0.0
    state = shifted(w.row, w.n_nodes * width)
    for node in range(w.n_nodes):
        apart = place - w.node[node]
        row = shifted(w.row, node * width)
        if apart == 0.0:
            copied(state, row, width)
            total = 1.0
            break
        factor = w.weight[node] / apart
        total += factor
        for i in range(width):
            state[i] += factor * row[i]
    for i in range(s.n_q):
        s.q[i] = state[i] / total
    for i in range(s.n_u):
        s.u[i] = state[s.n_q + i] / total
    for i in range(w.n_lam):
        s.lam[i] = state[w.n_state + i] / total


@compiled
def keep_row(w, s, node):
    """Store the current state as that of a node."""
    row = shifted(w.row, node * (w.n_state + w.n_lam))
    copied(row, s.q, s.n_q)
    copied(shifted(row, s.n_q), s.u, s.n_u)
    copied(shifted(row, w.n_state), s.lam, w.n_lam)


@compiled
def _values(w, s, begun, h, place):
    _load_at(w, s, place)
    return unwrapped(w, evaluate(s, SWITCH, begun + place * h))


@compiled
def _mismatch(w, part, noise):
    """Return the largest relative deviation from cubics of functions with possible events in a part."""
    worst = 0.0
    for k in range(w.n):
        if left_out(w, k):
            continue
        start, start_rate, end, end_rate = w.a[k], part * w.a_rate[k], w.b[k], part * w.b_rate[k]
        first = abs(w.m[k] - cubic(start, start_rate, end, end_rate, LOOKED_AT))
        second = abs(w.m2[k] - cubic(start, start_rate, end, end_rate, ALSO_AT))
        if not reaches(w, k, start, start_rate, end, end_rate, max(first, second)):
            continue
        seen = max(start, end, w.m[k], w.m2[k]) - min(start, end, w.m[k], w.m2[k])
        missed = max(first, second) / (SEARCH.fits * seen + noise + w.noise[k])
        worst = max(worst, missed) if isfinite(missed) else INFINITE
    return worst


@compiled
def _note_noise(w, s, begun, h, end, part):
    """Note the deviation from cubics that rounding explains: the change of rates over another time."""
    apart = 2.0 * SEARCH.difference * part
    nearby = _values(w, s, begun, h, end - apart)
    for k in range(w.n):
        w.noise[k] = SEARCH.unknown * part * abs((w.b[k] - nearby[k]) / apart - w.b_rate[k])


@compiled
def _extremum(start, start_rate, end, end_rate, which):
    """Return the first or second extremum of the cubic within (0, 1); 2 if there is none."""
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
    """Return True if the value of a function at `high` is an event; it was in the initial interval up to `low`.

    Rounding may change the sign of an event function for a moment; at the end of the step, any change counts.
    """
    one, other = interval(w, k, w.value_before[k]), interval(w, k, w.value_after[k])
    gone = departed(w, k, value)
    if gone and not 0.0 <= w.left_high[k] <= high:
        w.left_low[k], w.left_high[k] = low, high  # the stored one may be after a return
    if k < w.n_event_functions:
        return gone and (abs(value) > w.depth or high >= 1.0)
    if lands(w, k):
        return beyond(w, k, value, one, one, w.depth)
    if abs(one - other) > 1:
        return gone
    return beyond(w, k, value, one, other, w.depth)


@compiled
def _visits_extremum(w, s, begun, h, k, low, place, part):
    """Return True if a function has an event at its extremum near a place, refined by parabolas."""
    apart = SEARCH.refined * part
    for _ in range(SEARCH.refinements):
        here = _values(w, s, begun, h, place)[k]
        if _visits(w, k, here, low, place):
            return True
        apart = min(apart, place - low, low + part - place)
        before = _values(w, s, begun, h, place - apart)[k]
        after = _values(w, s, begun, h, place + apart)[k]
        curved = before - 2.0 * here + after
        if curved == 0.0 or not isfinite(curved):
            return False
        place += min(max(0.5 * apart * (before - after) / curved, -apart), apart)
        apart *= 0.1
    return False


@compiled
def _first_within(w, s, begun, h, low, end_of_part):
    """Return the place in the step of the first event of all functions within a part; 2 if there is none."""
    part = end_of_part - low
    first = 2.0
    for k in range(w.n):
        if left_out(w, k):
            continue
        start, start_rate, end, end_rate = w.a[k], part * w.a_rate[k], w.b[k], part * w.b_rate[k]
        seen = 2.0
        if _visits(w, k, w.m[k], low, low + LOOKED_AT * part):
            seen = LOOKED_AT
        elif _visits(w, k, w.m2[k], low, low + ALSO_AT * part):
            seen = ALSO_AT
        if reaches(w, k, start, start_rate, end, end_rate, 0.0):
            for which in range(2):
                place = _extremum(start, start_rate, end, end_rate, which)
                if place < min(seen, 1.0) and _visits_extremum(w, s, begun, h, k, low, low + place * part, part):
                    seen = place
        if seen > 1.0 and _visits(w, k, end, low, end_of_part):
            seen = 1.0
        if seen <= 1.0 and not _leaves_later(w, s, begun, h, k, first):
            place = _change(w, s, begun, h, k)
            if k >= w.n_event_functions or not departed(w, k, w.value_after[k]):  # the new law holds a little later
                place = min(1.0, place + SEARCH.least_difference)
            if place < first:
                first = place
                for j in range(w.n):
                    w.found[j] = 0
                w.found[k] = 1
    return first


@compiled
def _has_departed(w, s, begun, h, k, place):
    """Return True if a function has left its initial interval at a place, with the reactions there."""
    _load_at(w, s, place)
    return departed(w, k, switches(w, s, begun + place * h)[k])


@compiled
def _leaves_later(w, s, begun, h, k, place):
    """Return True if a function leaves its initial interval at a place or later; one place may have many functions."""
    return place <= w.left_high[k] and not _has_departed(w, s, begun, h, k, place - INDISTINCT)


@compiled
def _change(w, s, begun, h, k):
    """Return the place at which a function leaves its initial interval."""
    low, high = w.left_low[k], w.left_high[k]
    if w.by_accelerations and departed(w, k, w.value_after[k]) and not _has_departed(w, s, begun, h, k, high):
        low, high = high, 1.0  # a polynomial through reactions overshoots where these have a kink
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _has_departed(w, s, begun, h, k, middle):
            high = middle
        else:
            low = middle
    return high


@compiled
def _turned_in_part(w, part):
    """Return the largest change of a sine's argument in a part of the step, by values and rates there."""
    farthest = 0.0
    for i in range(w.n_turns):
        k = w.turn[i]
        farthest = max(farthest, turned_argument(w, i, w.b[k] - w.a[k]))
        farthest = max(farthest, turned_argument(w, i, w.m[k] - w.a[k]))
        farthest = max(farthest, turned_argument(w, i, w.m2[k] - w.a[k]))
        farthest = max(farthest, abs(w.radians[i]) * part * max(abs(w.a_rate[k]), abs(w.b_rate[k])))
    return farthest


@compiled
def _longest_part(w):
    """Return the longest part, 0.5 or less if a body rotates far: rates at its ends must represent the rotation."""
    last = shifted(w.row, (w.n_nodes - 1) * (w.n_state + w.n_lam))
    turned = 0.0
    for k in range(w.n_angles):
        turned = max(turned, abs(last[w.angle[k]] - w.row[w.angle[k]]))
    return max(min(0.5, SEARCH.turned / max(turned, SEARCH.turned)), SEARCH.finest)


@compiled
def first_event(w, s, begun, h):
    """Return the place, from 0 to 1, of the first event within a step from `begun`; 2 if there is none."""
    copied(w.a, w.value_before, w.n)
    for k in range(w.n):
        w.a_rate[k] = h * w.rate_before[k]
        w.left_high[k] = -1.0
    low = 0.0
    longest = _longest_part(w)
    part = max(min(longest, SEARCH.turned / max(fastest_turn(w, w.a_rate), SEARCH.turned)), SEARCH.finest)
    parts = 0
    most_parts = 1.0 / SEARCH.finest
    if turned_arguments(w, w.value_before, w.value_after) > most_parts * SEARCH.turned:
        most_parts = SEARCH.few_parts
    noise = 0.0
    for i in range(w.n_state):
        noise = max(noise, SEARCH.precision * abs(w.row[i]))
    w.depth = SEARCH.shallow * noise
    while low < 1.0:
        end = min(low + part, 1.0)
        part = end - low
        copied(w.b, w.value_after if end == 1.0 else _values(w, s, begun, h, end), w.n)
        noted_rates(
            w.b_rate, w.b, _values(w, s, begun, h, end - SEARCH.difference * part), -SEARCH.difference * part, w.n
        )
        copied(w.m, _values(w, s, begun, h, low + LOOKED_AT * part), w.n)
        copied(w.m2, _values(w, s, begun, h, low + ALSO_AT * part), w.n)
        parts += 1
        for k in range(w.n):
            w.noise[k] = 0.0
        missed = _mismatch(w, part, noise)
        if missed > 1.0:
            _note_noise(w, s, begun, h, end, part)
            missed = _mismatch(w, part, noise)
        turns = _turned_in_part(w, part)
        if (missed > 1.0 or turns > SEARCH.turned) and part > SEARCH.finest and parts < most_parts:
            part *= 0.5
            continue
        if turns > tau:
            note_unresolved(w, begun, w.a, w.b)
        place = _first_within(w, s, begun, h, low, end)
        if place <= 1.0:
            return place
        copied(w.a, w.b, w.n)
        copied(w.a_rate, w.b_rate, w.n)
        low = end
        part = min(2.0 * part, longest) if missed < SEARCH.well and turns < 0.5 * SEARCH.turned else part
    return 2.0
