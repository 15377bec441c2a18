"""IDA's callbacks with their C signatures, and the loop over its steps: no Python from one step to the next."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import NATIVE_IDA
from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, shifted, state_view, view_of
from stiffmbs.compile.machine.native.evaluate import SWITCH, add_entries, add_products, evaluate, load
from stiffmbs.solve.native.calls import call_address, call_int, copy_bytes, int32
from stiffmbs.solve.native.event_signs import watched
from stiffmbs.solve.native.iteration import AGE, MADE
from stiffmbs.solve.native.output_correction import CURRENT, LONG, balance_view, balanced
from stiffmbs.solve.native.step_bound import longest_step, step_bound_view
from stiffmbs.solve.native.within_step import (
    BEGUN,
    DIFFERENCE,
    LOOKED_AT,
    READY,
    clear,
    event_search_view,
    first_event,
    keep_row,
    noted,
    noted_rates,
    shift_ends,
    suspicious,
)

OK, RECOVERABLE = 0, 1
"""What a callback returns: after a recoverable failure IDA tries a smaller step."""
ONE_STEP = 2
STOP_RETURN, ROOT_RETURN = 1, 2
"""IDA_ONE_STEP, IDA_TSTOP_RETURN and IDA_ROOT_RETURN of ida.h."""
RETURNED, INTERNAL, SIZE, NEXT_SIZE = range(4)
"""Marks: the time of the returned state, the time that IDA has reached inside, the size of its last step (0 before the
first), and of the one that it will try next."""
STRETCHED = 1.01
"""The last step may be this much longer than inputs allow, so that no tiny one is left."""
SERVED, RECORDED, ORDER, TINY, SINCE, NEXT, WITHIN = range(7)
"""Counts: output points served, steps in the history, order of the last step, tiny steps in succession, steps since the
last sample, place of the next one, whether the last event was found by the search within the step."""
SAMPLES, STEPS_APART = 16, 4
"""The last states are kept as samples, one each few steps: the time and what is reported."""
HISTORY_WIDTH = 3
MOST_STEPS = 2048
"""Steps of any one call, and rows of the history (`stiffmbs.solve.ida.connection`)."""
STALLED = -101
START_DIFFERENCE, ROUNDINGS = 1e-9, 1e-15
"""Rates of event functions at a start are taken over this part of the time to the next stop; events nearer to a step's beginning
than this part of the time are not told from it."""
MOST_TINY, TINY_STEP = 100, 2e-14
"""IDA would go on forever with steps below the precision of time: this many below this part of t are the end."""

native_ida_view = view_of("NativeIda", NATIVE_IDA)


@compiled
def _array(c, vector):
    return floats(call_address(c.array_of, vector))


@compiled
def _finite(values, count):
    even = 0.0
    odd = 0.0  # two sums: each addition waits for the one before
    for k in range(0, count - 1, 2):
        even += 0.0 * values[k]
        odd += 0.0 * values[k + 1]
    if count % 2 == 1:
        even += 0.0 * values[count - 1]
    return even + odd == 0.0


def residual(t, yy, yp, rr, user_data):
    """IDAResFn: r(t, y, y')."""
    c = native_ida_view(user_data)
    s = state_view(c.state)
    e = equations_view(c.equations)
    y, rates, r = _array(c, yy), _array(c, yp), _array(c, rr)
    load(s, e, y, rates)
    add_products(e, evaluate(s, e.residual_set, t), y, rates, r)
    return int32(OK if _finite(r, e.n) else RECOVERABLE)


def jacobian(t, cj, yy, yp, rr, matrix, user_data, work1, work2, work3):
    """IDALsJacFn: the iteration matrix dr/dy + cj dr/dy'."""
    c = native_ida_view(user_data)
    s = state_view(c.state)
    e = equations_view(c.equations)
    load(s, e, _array(c, yy), _array(c, yp))
    a = floats(c.matrix)
    c.balance_mark[CURRENT] = cj
    c.iteration[AGE] = MADE
    add_entries(e, evaluate(s, e.matrix_set, t), cj, a)
    for k in range(0, 6, 3):
        copy_bytes(c.pattern[k], c.pattern[k + 1], c.pattern[k + 2])
    return int32(OK if _finite(a, e.n_slots) else RECOVERABLE)


def event_functions(t, yy, yp, g, user_data):
    """IDARootFn: what changes its sign at the breakpoints of forces."""
    c = native_ida_view(user_data)
    s = state_view(c.state)
    load(s, equations_view(c.equations), _array(c, yy), _array(c, yp))
    values = evaluate(s, SWITCH, t)
    watched(values, c.sides, c.waits, g, c.n_event_functions)
    return int32(OK if _finite(g, c.n_event_functions) else RECOVERABLE)


@compiled
def _see_inputs(c, stop):
    """Have IDA stop where a longer step might miss what an input does; it goes on from there with its history."""
    bound = step_bound_view(c.step_bound)
    if bound.n > 0:
        t = c.mark[INTERNAL]
        longest = longest_step(bound, t)
        call_int(c.next_step_of, (c.memory, shifted(c.mark, NEXT_SIZE)))
        first = c.mark[SIZE] == 0.0
        cut = (first or c.mark[NEXT_SIZE] > longest) and t + STRETCHED * longest < stop
        call_int(c.stop_at, (c.memory, t + longest if cut else stop))


@compiled
def _stepped(c, toward, stop):
    """One step; returns IDA's flag and notes the step's end, order and size in the history."""
    before = c.mark[INTERNAL]
    _see_inputs(c, stop)
    _watch_start(c, toward)
    flag = call_int(c.solve, (c.memory, toward, c.mark, c.y, c.yp, int32(ONE_STEP)))
    if flag == STOP_RETURN and c.mark[RETURNED] < stop:
        flag = int32(OK)
    call_int(c.time_of, (c.memory, shifted(c.mark, INTERNAL)))
    call_int(c.step_of, (c.memory, shifted(c.mark, SIZE)))
    if c.mark[INTERNAL] != before and flag >= 0:
        call_int(c.order_of, (c.memory, shifted(c.count, ORDER)))
        row = HISTORY_WIDTH * c.count[RECORDED]
        c.history[row] = c.mark[INTERNAL]
        c.history[row + 1] = float(c.count[ORDER])
        c.history[row + 2] = c.mark[SIZE]
        c.count[RECORDED] += 1
        _sample(c)
    if flag >= 0 and _stalled(c):
        return STALLED
    return _looked_within(c, flag) if flag >= 0 else flag


@compiled
def _note_rates(c, t, ahead, value, rate):
    """Rates of all event functions at the state in c.y, by their values there and a time `ahead` later, which may be negative."""
    s = state_view(c.state)
    e = equations_view(c.equations)
    w = event_search_view(c.watch)
    y, yp = _array(c, c.y), _array(c, c.yp)
    for k in range(e.n):
        c.probe[k] = y[k] + ahead * yp[k]
    load(s, e, c.probe, yp)
    noted_rates(rate, value, evaluate(s, SWITCH, t + ahead), ahead, w.n)


@compiled
def _watch_start(c, toward):
    """Where the integrator starts anew, look at the event functions there."""
    w = event_search_view(c.watch)
    c.count[WITHIN] = 0
    if w.n > 0 and w.mark[READY] == 0.0:
        w.mark[READY] = 1.0
        w.mark[BEGUN] = c.mark[RETURNED]
        ahead = max(START_DIFFERENCE * (toward - c.mark[RETURNED]), ROUNDINGS * abs(c.mark[RETURNED]))
        s = state_view(c.state)
        load(s, equations_view(c.equations), _array(c, c.y), _array(c, c.yp))
        keep_row(w, s, 0)
        noted(w.value_before, evaluate(s, SWITCH, c.mark[RETURNED]), w.n)
        _note_rates(c, c.mark[RETURNED], ahead, w.value_before, w.rate_before)


@compiled
def _looked_within(c, flag):
    """Where an event has begun and ended within the last step, go back to its beginning; IDA's flag, or ROOT_RETURN."""
    w = event_search_view(c.watch)
    if w.n == 0:
        return flag
    begun = w.mark[BEGUN]
    h = c.mark[RETURNED] - begun
    if not h > ROUNDINGS * abs(begun):
        return flag
    s = state_view(c.state)
    e = equations_view(c.equations)
    load(s, e, _array(c, c.y), _array(c, c.yp))
    noted(w.value_after, evaluate(s, SWITCH, c.mark[RETURNED]), w.n)
    if clear(w, h, w.row, s.q):
        keep_row(w, s, 0)
        w.mark[BEGUN] = c.mark[RETURNED]
        shift_ends(w)
        return flag
    _note_rates(c, c.mark[RETURNED], -DIFFERENCE * h, w.value_after, w.rate_after)
    place = begun + LOOKED_AT * h
    if call_int(c.interpolate, (c.memory, place, int32(0), c.at_output)) < 0:
        return flag
    load(s, e, c.output, _array(c, c.yp))
    noted(w.m, evaluate(s, SWITCH, place), w.n)
    load(s, e, _array(c, c.y), _array(c, c.yp))
    if suspicious(w, h, w.row, s.q):
        for node in range(w.n_nodes):
            if call_int(c.interpolate, (c.memory, begun + w.node[node] * h, int32(0), c.at_output)) < 0:
                return flag
            load(s, e, c.output, _array(c, c.yp))
            keep_row(w, s, node)
        event = begun + h * first_event(w, s, begun, h)
        if begun + ROUNDINGS * abs(begun) < event < c.mark[RETURNED]:
            call_int(c.interpolate, (c.memory, event, int32(0), c.y))
            call_int(c.interpolate, (c.memory, event, int32(1), c.yp))
            c.mark[RETURNED] = event
            c.count[WITHIN] = 1
            return int32(ROOT_RETURN)
        load(s, e, _array(c, c.y), _array(c, c.yp))
    keep_row(w, s, 0)
    w.mark[BEGUN] = c.mark[RETURNED]
    shift_ends(w)
    return flag


@compiled
def _report(c, values, row):
    for k in range(c.n_reported):
        row[k] = values[c.reported[k]]


@compiled
def _sample(c):
    c.count[SINCE] += 1
    if c.count[SINCE] == STEPS_APART:
        k = c.count[NEXT]
        row = shifted(c.samples, k * (c.n_reported + 1))
        row[0] = c.mark[RETURNED]
        _report(c, _array(c, c.y), shifted(row, 1))
        c.count[SINCE] = 0
        c.count[NEXT] = k + 1 if k + 1 < SAMPLES else 0


@compiled
def _stalled(c):
    c.count[TINY] = c.count[TINY] + 1 if abs(c.mark[SIZE]) < TINY_STEP * abs(c.mark[INTERNAL]) else 0
    return c.count[TINY] >= MOST_TINY


@compiled
def _report_at(c, t, derivative, current, row):
    """What is reported of the solution, or of its derivative, at a time within the last step."""
    if t == c.mark[RETURNED]:
        _report(c, _array(c, current), row)
        return int32(OK)
    if c.mark[SIZE] > c.balance_mark[LONG] and balanced(c.balance, c.state, c.equations, t):
        b = balance_view(c.balance)
        _report(c, b.yp if derivative else b.y, row)
        return int32(OK)
    flag = call_int(c.interpolate, (c.memory, t, int32(derivative), c.at_output))
    _report(c, c.output, row)
    return flag


@compiled
def _served(c, times, count, y_out, yp_out):
    """Serve the output times up to the returned one; `yp_out` may be null."""
    flag = int32(OK)
    while c.count[SERVED] < count and times[c.count[SERVED]] <= c.mark[RETURNED]:
        k = c.count[SERVED]
        flag = _report_at(c, times[k], 0, c.y, shifted(y_out, k * c.n_reported))
        if flag >= 0 and yp_out != 0:
            flag = _report_at(c, times[k], 1, c.yp, shifted(floats(yp_out), k * c.n_reported))
        if flag < 0:
            break
        c.count[SERVED] = k + 1
    return flag


def advance(count, times, stop, most, y_out, yp_out, ida):
    """At most `most` steps, and as many as there is room for, towards `stop`, serving output times on the way; returns IDA's last flag.

    The first step's size follows from the distance to the first output time, as in IDA's own mode for them.
    """
    c = native_ida_view(ida)
    c.count[SERVED] = 0
    c.count[RECORDED] = 0
    flag = _served(c, times, count, y_out, yp_out)
    for _ in range(min(most, MOST_STEPS)):
        if flag != OK:
            break
        flag = _stepped(c, times[c.count[SERVED]] if c.count[SERVED] < count else stop, stop)
        if flag >= 0:
            told = _served(c, times, count, y_out, yp_out)
            flag = told if told < 0 else flag
    return int32(flag)


def steps(room, stop, t_out, y_out, ida):
    """At most `room` steps towards `stop`, each of them reported; returns IDA's last flag."""
    c = native_ida_view(ida)
    c.count[SERVED] = 0
    c.count[RECORDED] = 0
    flag = int32(OK)
    while flag == OK and c.count[SERVED] < min(room, MOST_STEPS):
        flag = _stepped(c, stop, stop)
        if flag >= 0:
            k = c.count[SERVED]
            t_out[k] = c.mark[RETURNED]
            _report(c, _array(c, c.y), shifted(y_out, k * c.n_reported))
            c.count[SERVED] = k + 1
    return int32(flag)
