"""Record of the steps in which arguments of tables are outside the points of these."""

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.solve.events.native.bounds import cubic
from stiffmbs.solve.events.native.parameters import BISECTIONS

PARTS = 16
"""Parts of a step whose middles decide for how long a function is outside."""


@compiled
def _farther(w, k, value):
    """Extend the range of a function; values that are not finite are ignored."""
    if isfinite(value):
        w.lowest[k] = min(w.lowest[k], value)
        w.highest[k] = max(w.highest[k], value)


@compiled
def _is_outside(value, low, high):
    return value < low or value > high


@compiled
def _first_outside(k, w, h, low, high, most):
    """Return the part of the step at which a cubic that is outside at `most` leaves the range."""
    inside, outside = 0.0, most
    if _is_outside(w.value_before[k], low, high):
        return 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        if _is_outside(_at(k, w, h, middle), low, high):
            outside = middle
        else:
            inside = middle
    return outside


@compiled
def _at(k, w, h, place):
    return cubic(w.value_before[k], h * w.rate_before[k], w.value_after[k], h * w.rate_after[k], place)


@compiled
def note_outside(w, t):
    """Note the range of each argument of a table in a step up to t, and the time that it spends outside the table.

    Values and rates at both ends define a cubic.  A law near a breakpoint is known at `LOOKED_AT` too.
    """
    h = t - w.begun
    passed = max(w.begun - w.noted, 0.0)
    w.noted = t
    for k in range(w.n_event_functions, w.n):
        if not w.tables[k]:
            continue
        low, high = w.breakpoints[w.first_breakpoint[k]], w.breakpoints[w.first_breakpoint[k + 1] - 1]
        start, last = w.value_before[k], w.value_after[k]
        away = max(abs(last - start), h * max(abs(w.rate_before[k]), abs(w.rate_after[k])))
        if min(start, last) - away >= low and max(start, last) + away <= high:
            continue
        _farther(w, k, start)
        _farther(w, k, last)
        if w.near[w.call[k]]:
            _farther(w, k, w.m[k])
        parts, earliest = 0, 2.0
        for part in range(PARTS):
            place = (part + 0.5) / PARTS
            value = _at(k, w, h, place)
            _farther(w, k, value)
            if _is_outside(value, low, high):
                parts += 1
                earliest = min(earliest, place)
        if _is_outside(last, low, high):
            earliest = min(earliest, 1.0)
        if _is_outside(start, low, high):
            w.outside[k] += passed
            earliest = 0.0
        w.outside[k] += h * parts / PARTS
        if earliest <= 1.0 and not w.left[k] <= t:
            w.left[k] = w.begun + h * _first_outside(k, w, h, low, high, earliest)
