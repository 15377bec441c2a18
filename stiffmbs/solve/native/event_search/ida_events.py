"""Events that begin and end within a step of IDA's; compiled for scenes with event functions alone."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate, evaluate_some, load
from stiffmbs.solve.native.calls import call_int, int32
from stiffmbs.solve.native.event_search.bounds import (
    LOOKED_AT,
    event_search_view,
    noted,
    noted_rates,
    shift_ends,
    suspicious,
)
from stiffmbs.solve.native.event_search.nearby import note_mean_rates, note_near
from stiffmbs.solve.native.event_search.within_step import DIFFERENCE, first_event, keep_row
from stiffmbs.solve.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.native.statuses import OK

UNSEEN = float("inf")
"""No time at which event functions are known."""
START_DIFFERENCE, ROUNDINGS = 1e-9, 1e-15
"""Rates of event functions at a start are taken over this part of the time to the next stop; events nearer to a step's beginning
than this part of the time are not told from it."""


@compiled
def _go_straight(c, s, ahead):
    """Load the state to which the one in c.y goes at its present rates, in a time that may be negative."""
    y, yp = array_of(c, c.y), array_of(c, c.yp)
    e = equations_view(c.equations)
    for k in range(e.n):
        c.probe[k] = y[k] + ahead * yp[k]
    load(s, e, c.probe, yp)


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
        _go_straight(c, s, ahead)
        noted_rates(w.rate_before, w.value_before, evaluate(s, SWITCH, c.returned + ahead), ahead, w.n)
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
    nearby = note_near(w, h, w.row, s.q)
    if not nearby:
        note_mean_rates(w, h)
        keep_row(w, s, 0)
        w.begun = c.returned
        shift_ends(w)
        return int32(0)
    ahead = -DIFFERENCE * h
    _go_straight(c, s, ahead)
    noted_rates(w.rate_after, w.value_after, evaluate_some(s, SWITCH, c.returned + ahead, w.near), ahead, w.n)
    note_mean_rates(w, h)
    place = begun + LOOKED_AT * h
    if call_int(c.interpolate, (c.memory, place, int32(0), c.at_output)) < 0:
        return int32(0)
    load(s, e, c.output, array_of(c, c.yp))
    noted(w.m, evaluate_some(s, SWITCH, place, w.near), w.n)
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
