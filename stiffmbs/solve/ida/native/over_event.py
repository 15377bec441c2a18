"""Steps of IDA that cross an event are repeated up to the event.

The force beyond an event acts in all of a BDF step that crosses it.  The predictor knows the force before the event
alone.  The deviation of the corrector from it, times the place of the event in the step, is the error of the state at
the event.  The error test of IDA divides that deviation by the order + 1.  If the error exceeds the tolerance of an
unknown, the norm makes the error test fail, and IDA takes a step up to just before the event.

References
----------
L. F. Shampine, S. Thompson, Event location for ordinary differential equations, Comput. Math. Appl. 39 (2000) 43-54.
"""

from math import sqrt

from stiffmbs.compile.machine.native.access import address_of, compiled, equations_view, state_view
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.events.native.bounds import breakpoint_of, departed, event_search_view, interval, note_changes
from stiffmbs.solve.events.native.parameters import SEARCH
from stiffmbs.solve.events.native.values import unwrapped
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view


@compiled
def _crossing(w, k, h, value):
    """Return the place from 0 to 1 where function k leaves its interval, by its value and rate at the start and its end."""
    number, last = interval(w, k, w.value_before[k]), interval(w, k, value)
    edge = breakpoint_of(w, k, number if last > number else number - 1)
    a, b = w.value_before[k] - edge, h * w.rate_before[k]
    c = value - edge - a - b
    root = sqrt(max(b * b - 4.0 * a * c, 0.0))
    half = -0.5 * (b + root if b >= 0.0 else b - root)
    place = 1.0
    if c != 0.0 and 0.0 < half / c < 1.0:
        place = half / c
    if half != 0.0 and 0.0 < a / half < 1.0:
        place = a / half
    return place


@compiled
def _crosses(c, w, s, t):
    """Return True if an event function has changed at the end of an attempted step; note the functions."""
    load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
    copied(w.value_after, unwrapped(w, evaluate(s, SWITCH, t)), w.n)
    return note_changes(w, w.value_after) > 0


@compiled
def _first_crossing(c, w, s, d, t):
    """Return the place of the first event, by the motion predicted with the forces before it, at distance `d` from the end."""
    e, y = equations_view(c.equations), array_of(c, c.y)
    for k in range(e.n):
        c.probe[k] = y[k] - d[k]
    load(s, e, c.probe, array_of(c, c.yp))
    predicted = evaluate(s, SWITCH, t)
    first = 1.0
    for k in range(w.n_event_functions):
        if w.found[k]:
            value = predicted[k] if departed(w, k, predicted[k]) else w.value_after[k]
            first = min(first, _crossing(w, k, t - w.begun, value))
            w.found[k] = 0
    return first


def part_before_event(estimate, weights, ida):
    """Return the part of an attempted step up to an event, if the step has to be repeated up to there; else 1."""
    c = native_ida_view(ida)
    w = event_search_view(c.watch)
    call_int(c.time_of, (c.memory, address_of(c.attempted)))
    s = state_view(c.state)
    if w.by_accelerations != 0 or not (c.attempted > w.begun and _crosses(c, w, s, c.attempted)):
        return 1.0
    d, weight = array_of(c, estimate), array_of(c, weights)
    place = _first_crossing(c, w, s, d, c.attempted)
    largest = 0.0
    for k in range(equations_view(c.equations).n):
        largest = max(largest, abs(d[k]) * weight[k])
    if not place * largest > 1.0:
        return 1.0
    return (1.0 - max(0.5 / largest, SEARCH.finest)) * place  # a step over the rest is within half the tolerance
