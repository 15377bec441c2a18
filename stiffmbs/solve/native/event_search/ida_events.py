"""Events that begin and end within a step of IDA's; compiled for scenes with event functions alone."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate, load
from stiffmbs.solve.native.calls import call_int, int32
from stiffmbs.solve.native.event_search.bounds import (
    LOOKED_AT,
    clear,
    event_search_view,
    noted,
    noted_rates,
    shift_ends,
    suspicious,
)
from stiffmbs.solve.native.event_search.within_step import DIFFERENCE, first_event, keep_row
from stiffmbs.solve.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.native.statuses import OK

UNSEEN = float("inf")
"""No time at which event functions are known."""
START_DIFFERENCE, ROUNDINGS = 1e-9, 1e-15
"""Rates of event functions at a start are taken over this part of the time to the next stop; events nearer to a step's beginning
than this part of the time are not told from it."""


@compiled
def _note_rates(c, t, ahead, value, rate):
    """Rates of all event functions at the state in c.y, by their values there and a time `ahead` later, which may be negative."""
    s = state_view(c.state)
    e = equations_view(c.equations)
    w = event_search_view(c.watch)
    y, yp = array_of(c, c.y), array_of(c, c.yp)
    for k in range(e.n):
        c.probe[k] = y[k] + ahead * yp[k]
    load(s, e, c.probe, yp)
    noted_rates(rate, value, evaluate(s, SWITCH, t + ahead), ahead, w.n)


def look_at_start(toward, ida):
    """Where the integrator starts anew, look at the event functions there."""
    c = native_ida_view(ida)
    w = event_search_view(c.watch)
    if not w.ready:
        w.ready = 1
        w.begun = c.returned
        ahead = max(START_DIFFERENCE * (toward - c.returned), ROUNDINGS * abs(c.returned))
        s = state_view(c.state)
        load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
        c.seen = UNSEEN
        keep_row(w, s, 0)
        noted(w.value_before, evaluate(s, SWITCH, c.returned), w.n)
        _note_rates(c, c.returned, ahead, w.value_before, w.rate_before)
    return int32(OK)


def look_within(ida):
    """Where an event has begun and ended within the last step, go back to its beginning; whether there is one."""
    c = native_ida_view(ida)
    w = event_search_view(c.watch)
    begun = w.begun
    h = c.returned - begun
    if not h > ROUNDINGS * abs(begun):
        return int32(0)
    s = state_view(c.state)
    e = equations_view(c.equations)
    if c.seen != c.returned:
        load(s, e, array_of(c, c.y), array_of(c, c.yp))
        evaluate(s, SWITCH, c.returned)
    c.seen = UNSEEN
    noted(w.value_after, floats(s.values[SWITCH]), w.n)
    if clear(w, h, w.row, s.q):
        keep_row(w, s, 0)
        w.begun = c.returned
        shift_ends(w)
        return int32(0)
    _note_rates(c, c.returned, -DIFFERENCE * h, w.value_after, w.rate_after)
    place = begun + LOOKED_AT * h
    if call_int(c.interpolate, (c.memory, place, int32(0), c.at_output)) < 0:
        return int32(0)
    load(s, e, c.output, array_of(c, c.yp))
    noted(w.m, evaluate(s, SWITCH, place), w.n)
    load(s, e, array_of(c, c.y), array_of(c, c.yp))
    if suspicious(w, h, w.row, s.q):
        for node in range(w.n_nodes):
            if call_int(c.interpolate, (c.memory, begun + w.node[node] * h, int32(0), c.at_output)) < 0:
                return int32(0)
            load(s, e, c.output, array_of(c, c.yp))
            keep_row(w, s, node)
        event = begun + h * first_event(w, s, begun, h)
        if begun + ROUNDINGS * abs(begun) < event < c.returned:
            call_int(c.interpolate, (c.memory, event, int32(0), c.y))
            call_int(c.interpolate, (c.memory, event, int32(1), c.yp))
            c.returned = event
            c.within = 1
            return int32(1)
        load(s, e, array_of(c, c.y), array_of(c, c.yp))
    keep_row(w, s, 0)
    w.begun = c.returned
    shift_ends(w)
    return int32(0)
