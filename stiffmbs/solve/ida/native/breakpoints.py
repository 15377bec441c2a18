"""Integration over breakpoints in one call: IDA restarts at each that requires only consistent values."""

from typing import Final

from stiffmbs.compile.machine.native.access import address_of, compiled, equations_view, ints, state_view
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import POSITION, SWITCH, evaluate, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.compile.machine.native.statuses import OK, STOP_RETURN
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.sign_changes import crossed, moved_past, taken_back, until_changed
from stiffmbs.solve.ida.native.ida_loop import advanced, clear_call, stepped
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.ida.native.parameters import LOOP
from stiffmbs.solve.ida.native.start import accelerated, begun, brought_back, keep_counters, prepare, start_view

UNFINISHED: Final = -1
"""Result of a restart that has no consistent values, or that is left to Python."""


@compiled
def _take_state(s, w, e, y, yp):
    """Load the state from the unknowns; constant coordinates are as at the last start."""
    for k in range(s.n_q):
        if w.leader[k] < 0:
            s.q[k] = e.offset[k]
    for k in range(s.n_u):
        s.u[k] = 0.0
    load(s, e, y, yp)


@compiled
def _same_offsets(s, w, e):
    """Return True if dependent coordinates keep the offsets of the last start, used for all rows of a call."""
    others = 0
    for k in range(s.n_q):
        leader = w.leader[k]
        others += e.offset[k] != s.q[k] - (e.q_ratio[k] * s.q[leader] if leader >= 0 else 0.0)
    return others == 0


@compiled
def _beyond_limits(w, s, t):
    if w.first_limit == w.n_event_functions:
        return False
    values = evaluate(s, SWITCH, t)
    beyond = 0
    for k in range(w.first_limit, w.n_event_functions):
        beyond += values[k] <= 0.0
    return beyond > 0


@compiled
def _started(w, c, s, m, t, counted, highest_order):
    """Start IDA at the current state, which is on the constraints; a negative number if nothing was started."""
    if accelerated(s, m, t) < 0 or _beyond_limits(w, s, t):
        return UNFINISHED
    prepare(w, s, m, equations_view(c.equations), c, t)
    if counted:
        keep_counters(w)
    return begun(w, c, t, highest_order)


@compiled
def _restarted_at_breakpoint(w, c, t, highest_order):
    """Restart at t from IDA's current state; a negative number, with IDA unchanged, leaves the restart to Python."""
    m = dynamics_view(w.dynamics)
    s = state_view(m.state)
    e = equations_view(c.equations)
    _take_state(s, w, e, array_of(c, c.y), array_of(c, c.yp))
    copied(w.u, s.u, s.n_u)
    add_rates(s, w.u, w.gap, s.q)
    if back_with_jump(w, s, m, t) < 0 or w.jumps:
        return UNFINISHED
    restart_counters(w, s, t)
    if not _same_offsets(s, w, e) or _started(w, c, s, m, t, 1, highest_order) < 0:
        return UNFINISHED
    w.t = t
    return OK


def advance_past(count, times, n_stops, stops, most, highest_order, y_out, table, ida):
    """Integrate by at most `most` steps to each stop, restart after all but the last; return IDA's last flag.

    Returns at a stop that Python has to handle; the table holds the number of stops passed.
    """
    w = start_view(table)
    c = native_ida_view(ida)
    s = state_view(c.state)
    clear_call(c)
    w.passed = 0
    w.steps_before = 0
    while True:
        stop = stops[w.passed]
        flag = call_int(c.stop_at, (c.memory, stop))
        if flag < 0:
            return int32(flag)
        flag = advanced(c, ida, count, times, stop, most, y_out)
        if flag != STOP_RETURN or w.passed + 1 == n_stops or c.recorded + most > 2 * LOOP.most_steps:
            return int32(flag)
        t = c.returned + w.gap
        same = t + w.gap
        open_ = s.n_c > 0 and c.size > output_correction_view(c.output_correction).long
        if open_ or same >= stops[w.passed + 1] or (c.served < count and times[c.served] <= same):
            return int32(flag)
        if _restarted_at_breakpoint(w, c, t, highest_order) < 0:
            return int32(flag)
        w.passed += 1
        w.steps_before = c.recorded


@compiled
def _meets(w, s, t):
    """Return True if event functions of velocities change sign near the current state, which is unchanged in the end."""
    count = w.n_event_functions
    copied(w.q, s.q, s.n_q)
    copied(w.u, s.u, s.n_u)
    return crossed(t, w.reach, w.q, w.u, w.along_q, w.along_u, count, w.found, w.kept, w.values, w.dynamics) > 0


@compiled
def back_with_jump(w, s, m, t):
    """Project the current state onto the constraints and note if velocities or positions jump; 0 or a negative status."""
    copied(w.q, s.q, s.n_q)
    copied(w.u, s.u, s.n_u)
    status = brought_back(s, m, t)
    jump = 0.0
    fastest = 0.0
    for k in range(s.n_u):
        jump = max(jump, w.speed[k] * abs(s.u[k] - w.u[k]))
        fastest = max(fastest, w.speed[k] * max(abs(s.u[k]), abs(w.u[k])))
    move = 0.0
    for k in range(s.n_q):
        move = max(move, abs(s.q[k] - w.q[k]))
    w.jumps = 1 if move > w.least_jump or jump > max(w.least_jump, w.largest_jump * fastest) else 0
    return status


@compiled
def _as_far_as_projected(w, c, s):
    """Return the time in which the motion changes by as many tolerances as the projection of the current state.

    Accelerations must be those of the current state: near a turning point, velocities alone would give too long a time.
    """
    for k in range(s.n_q):
        w.rate[k] = 0.0
    add_rates(s, s.u, 1.0, w.rate)
    moved = 0.0
    rate = 0.0
    for i in range(w.n_q):
        k = w.q_of[i]
        tolerance = c.atol[w.q_at[i]] + c.rtol * abs(w.q[k])
        moved = max(moved, abs(s.q[k] - w.q[k]) / tolerance)
        rate = max(rate, abs(w.rate[k]) / tolerance)
    for i in range(w.n_u):
        k = w.u_of[i]
        tolerance = c.atol[w.u_at[i]] + c.rtol * abs(w.u[k])
        moved = max(moved, abs(s.u[k] - w.u[k]) / tolerance)
        rate = max(rate, abs(s.a[k]) / tolerance)
    return moved / rate if rate > 0.0 else 0.0


@compiled
def _of_events_at_once(w, c, s, m, t, ahead, stop):
    """Return the time of extrapolation past events at t: `ahead`, or longer if the projection led back before an event."""
    count = w.n_event_functions
    if taken_back(s, m, t, ahead, count, w.q, w.kept, w.values, w.found) == 0 or accelerated(s, m, t) < 0:
        return ahead
    longest = min(_as_far_as_projected(w, c, s), 0.5 * min(stop - t, c.size))
    return until_changed(s, m, t, ahead, longest, count, w.kept, w.found)


@compiled
def restart_counters(w, s, t):
    """Set the revolution counters to the exact angles that they count."""
    if w.n_counters_of_angles > 0:
        values = evaluate(s, POSITION, t)
        for k in range(w.n_counters_of_angles):
            s.q[w.angle_row[k]] = values[w.angle_source[k]]


def restarted_at_event(t, ahead, stop, counted, highest_order, table):
    """Project the current state, move it past simultaneous events, and start IDA; OK or a negative number.

    `ahead`: least time in which events are simultaneous, 0 for none.  `stop`: next time at which IDA stops.

    A negative number means that nothing was started, and Python determines the reason.
    """
    w = start_view(table)
    m = dynamics_view(w.dynamics)
    s = state_view(m.state)
    c = native_ida_view(ints(w.ida))
    if back_with_jump(w, s, m, t) < 0:
        return int32(UNFINISHED)
    after = t
    if ahead > 0.0:
        most = _of_events_at_once(w, c, s, m, t, ahead, stop)
        after += moved_past(s, m, t, most, w.n_event_functions, w.q, w.values)
    restart_counters(w, s, after)
    if _started(w, c, s, m, after, counted, highest_order) < 0:
        return int32(UNFINISHED)
    w.t = after
    w.meets = _meets(w, s, after) if w.n_event_functions > 0 else 0
    return int32(OK)


def advance_from(t, end, highest_order, table):
    """Start at the current state at t and integrate to `end`, where the current state is the result; return OK.

    The first step is as long as the last call has left it. Too many steps, an event or a failure give another number.
    """
    if restarted_at_event(t, 0.0, end, 0, highest_order, table) < 0:
        return int32(UNFINISHED)
    w = start_view(table)
    ida = ints(w.ida)
    c = native_ida_view(ida)
    call_int(w.set_first_step, (c.memory, min(c.next_size, end - t)))
    call_int(c.stop_at, (c.memory, end))
    c.stopping = end
    clear_call(c)
    flag = int32(OK)
    for _ in range(LOOP.most_steps):
        if flag != OK:
            break
        flag = stepped(c, ida, end)
    if flag != STOP_RETURN:
        return int32(UNFINISHED)
    call_int(c.next_step_of, (c.memory, address_of(c.next_size)))
    c.next_size = max(c.next_size, c.size)
    load(state_view(c.state), equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
    return int32(OK)
