"""Events within a step of IDA; compiled only for scenes with event functions."""

from typing import Final

from stiffmbs.compile.machine.native.access import compiled, equations_view, state_view
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate_some, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK
from stiffmbs.solve.events.native.bounds import (
    LOOKED_AT,
    breakpoint_of,
    departed,
    event_search_view,
    interval,
    lands,
    note_changes,
    noted_rates,
    overlap,
    suspicious,
    time_of_difference,
)
from stiffmbs.solve.events.native.layouts import ALWAYS, EVENT, IN_THIS_STEP, NO_EVENT, PASSED_INTERVAL
from stiffmbs.solve.events.native.locate import FAR, evaluate_near, go_on, located, note_rates, note_values
from stiffmbs.solve.events.native.nearby import near_an_event, note_mean_rates, note_near
from stiffmbs.solve.events.native.parameters import EPSILON, INDISTINCT, NEXT_STEP, SEARCH
from stiffmbs.solve.events.native.signs_at_zero import find_signs
from stiffmbs.solve.events.native.values import switches, take_reactions, unwrapped
from stiffmbs.solve.events.native.within_step import first_event, keep_row
from stiffmbs.solve.ida.native.first_steps import bound_first_steps, go_ahead, go_straight
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view

LARGEST_GROWTH: Final = 2.0
"""Largest ratio of successive steps of IDA (IDASetEtaMax, which is not called)."""


def look_at_start(toward, stop, ida):
    """Evaluate the event functions at a restart of IDA; times of the first step `toward` and of the next breakpoint `stop`."""
    c = native_ida_view(ida)
    w = event_search_view(c.watch)
    if w.begun == float("inf"):
        t, way = c.returned, toward - c.returned
        s = state_view(c.state)
        load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
        note_values(w, s, t)
        note_rates(c, w, s, t, max(SEARCH.least_difference * way, time_of_difference(w, 0.0, t)), go_straight)
        find_signs(c, w, s, t, max(EPSILON * way, INDISTINCT * abs(t)), SEARCH.difference * way, go_ahead)
        bound_first_steps(c, w, s, toward, stop)
    return int32(OK)


@compiled
def _look_ahead(c, w, s):
    """Make the next step resolve the intervals of laws, and end before an event, if breakpoints are near."""
    if w.n_turns == 0 or w.n_with_intervals == 0 or w.longest == float("inf"):
        return
    ahead = min(w.longest, LARGEST_GROWTH * c.size)
    go_ahead(c, s, ahead)
    copied(w.value_after, switches(w, s, c.returned + ahead), w.n)
    if note_near(w, ahead, w.row, s.q):
        event = near_an_event(w, ahead, w.row, s.q)
        _look_at_middle(c, w, s, ahead)
        if w.n_with_intervals > w.n_event_functions:
            ahead = _resolve_intervals(c, w, s, ahead)
        if event:
            _aim(c, w, s, ahead)
    load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))


@compiled
def _look_at_middle(c, w, s, ahead):
    """Evaluate functions near breakpoints at a place within the extrapolation by accelerations."""
    go_ahead(c, s, LOOKED_AT * ahead)
    take_reactions(w, s, c.returned + LOOKED_AT * ahead)
    copied(w.m, unwrapped(w, evaluate_some(s, SWITCH, c.returned + LOOKED_AT * ahead, w.near)), w.n)


@compiled
def _within_intervals(w):
    """Return True if laws pass at most a fraction of their intervals in either part of a step."""
    beyond = 0
    for k in range(w.n_event_functions, w.n):
        if w.first_breakpoint[k] == w.first_breakpoint[k + 1] or not w.near[w.call[k]]:
            continue
        start, middle, end = w.value_before[k], w.m[k], w.value_after[k]
        narrowest = min(_narrowest(w, k, start, middle), _narrowest(w, k, start, end))
        beyond += max(abs(middle - start), abs(end - middle)) > NEXT_STEP.of_an_interval * narrowest
    return beyond == 0


@compiled
def _narrowest(w, k, start, end):
    """Return the narrowest interval of function k between two values that is wider than its distance from the start."""
    number, last = interval(w, k, start), interval(w, k, end)
    sense = 1 if last > number else -1
    narrowest = min(_width(w, k, number), _width(w, k, last))
    left = min(abs(last - number), w.first_breakpoint[k + 1] - w.first_breakpoint[k])
    for _ in range(left):
        near = breakpoint_of(w, k, number if sense > 0 else number - 1)
        number += sense
        width = _width(w, k, number)
        if width > abs(near - start):
            narrowest = min(narrowest, width)
    return narrowest


@compiled
def _width(w, k, number):
    """Return the width of an interval; infinite for the outer ones."""
    if w.period[k] == 0.0 and not 0 < number < w.first_breakpoint[k + 1] - w.first_breakpoint[k]:
        return float("inf")
    return breakpoint_of(w, k, number) - breakpoint_of(w, k, number - 1)


@compiled
def _resolve_intervals(c, w, s, most):
    """Limit the next step so that the extrapolated motion passes each interval of a law in several steps."""
    ahead = most
    while ahead > w.least and not _within_intervals(w):
        ahead *= LOOKED_AT
        w.longest = max(ahead, w.least)
        copied(w.value_after, w.m, w.n)
        _look_at_middle(c, w, s, ahead)
    return ahead


@compiled
def _aim(c, w, s, ahead):
    """Make the next step end just before an event of the motion extrapolated by accelerations.

    From there, a one-step method takes a step to just after the event. It would take one of the length before otherwise.
    """
    t, back = c.returned, -time_of_difference(w, ahead, c.returned)
    go_ahead(c, s, ahead + back)
    noted_rates(w.rate_after, w.value_after, evaluate_near(w, s, t + ahead + back), back, w.n)
    note_mean_rates(w, ahead)
    if not suspicious(w, ahead, w.row, s.q):
        return
    for node in range(w.n_nodes):
        go_ahead(c, s, ahead * w.node[node])
        take_reactions(w, s, t + ahead * w.node[node])
        keep_row(w, s, node)
    unresolved = w.unresolved
    place = first_event(w, s, t, ahead)
    w.unresolved = unresolved  # this motion is extrapolated only
    for k in range(w.n):
        w.found[k] = 0
    least = max(NEXT_STEP.short_of * w.longest, 10.0 * INDISTINCT * abs(t))
    if 3.0 * least < ahead * place < ahead:
        w.target = t + ahead * place - max(least, SEARCH.finest * ahead * place)
    elif c.repeat and place <= 1.0:
        w.target = t + ahead * place + 3.0 * least


@compiled
def _go_back(c, w, s, begun, h, place):
    """Make a place within the last step IDA's returned state; note all event functions that have changed up to there.

    Rounding may leave the interpolated state just before the event.
    """
    end, last = c.returned, min(1.0, place + SEARCH.finest)
    apart = INDISTINCT * abs(end) / h
    changed = 0
    while True:
        c.returned = max(min(begun + place * h, end), c.internal - c.size)
        call_int(c.interpolate, (c.memory, c.returned, int32(0), c.y))
        call_int(c.interpolate, (c.memory, c.returned, int32(1), c.yp))
        load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
        values = switches(w, s, c.returned)
        for k in range(w.n):
            changed += w.found[k] and departed(w, k, values[k])
        if changed > 0 or place >= last:
            break
        place = min(place + apart, last)
        apart *= SEARCH.longer
    note_changes(w, values)


@compiled
def _passes_smoothly(w, h):
    """Return True if the event found is a passed interval of a law that is smooth where a repeated step may end."""
    others = 0
    for k in range(w.n):
        if w.found[k]:
            number = interval(w, k, w.value_before[k])
            smooth = min(overlap(w, k, number - 1), overlap(w, k, number))
            farthest = max(
                abs(w.value_after[k] - w.value_before[k]), h * max(abs(w.rate_before[k]), abs(w.rate_after[k]))
            )
            restarts = w.at_kinks == ALWAYS if lands(w, k) else smooth < SEARCH.difference * farthest
            others += k < w.n_event_functions or restarts
    return others == 0


@compiled
def _load_within(c, s, ahead):
    """Load the state of the last step a time after the start of the search; negative if there is none.

    The search begins before the step if indistinct steps precede, which are not searched by themselves.
    """
    t = max(event_search_view(c.watch).begun + ahead, c.internal - c.size)
    flag = call_int(c.interpolate, (c.memory, t, int32(0), c.at_output))
    load(s, equations_view(c.equations), c.output, array_of(c, c.yp))
    return flag


def look_within(ida):
    """Set IDA's returned state to the first event within the last step; return `NO_EVENT`, `EVENT` or `PASSED_INTERVAL`."""
    c = native_ida_view(ida)
    w = event_search_view(c.watch)
    begun = w.begun
    h = c.returned - begun
    if not h > INDISTINCT * abs(begun):
        return int32(NO_EVENT)
    if w.at_kinks != ALWAYS:
        w.at_kinks = IN_THIS_STEP if c.repeat and not call_int(c.resolves, (c.memory,)) else 0
    s = state_view(c.state)
    load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
    copied(w.value_after, switches(w, s, c.returned), w.n)
    place = located(c, w, s, c.returned, go_straight, _load_within, _load_within)
    passes = 0.0 <= place <= 1.0 and _passes_smoothly(w, h)
    if (
        0.0 <= place <= (1.0 - 2.0 * SEARCH.difference if passes and c.repeat else 1.0)
    ):  # a repeated step ends in the law
        _go_back(c, w, s, begun, h, place)
        return int32(PASSED_INTERVAL if passes else EVENT)
    if place >= 0.0:
        load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
        go_on(w, s, c.returned)
        if place != FAR:
            _look_ahead(c, w, s)
    return int32(NO_EVENT)
