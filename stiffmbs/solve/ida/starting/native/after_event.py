"""Restart after an event or a breakpoint in one call: consistent values, limits of forces, start of IDA."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view, ints, state_view, view_of
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import POSITION, SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.past import moved_past
from stiffmbs.solve.events.native.sides import crossing, following_velocities
from stiffmbs.solve.ida.native.ida_memory import native_ida_view
from stiffmbs.solve.ida.native.layouts import ANEW
from stiffmbs.solve.ida.starting.native.restart import accelerated, brought_back
from stiffmbs.solve.ida.starting.native.start import UNFINISHED, begun, keep_counters, prepared, start_view

anew_view = view_of("Anew", ANEW)


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
def _meets(w, s, m, t):
    """Return 1 if event functions of velocities change sign near the current state, which is restored."""
    count = w.n_event_functions
    copied(w.q, s.q, s.n_q)
    copied(w.u, s.u, s.n_u)
    meets = 0
    if crossing(s, m, t, w.reach, w.q, w.u, w.along_q, w.along_u, count, w.found) > 0:
        following_velocities(s, m, t, w.reach, w.q, w.u, w.along_u, count, w.values)
        for k in range(count):
            if w.found[k] != 0 and w.values[k] != 0.0:
                meets = 1
    copied(s.q, w.q, s.n_q)
    copied(s.u, w.u, s.n_u)
    return meets


@compiled
def back_with_jump(w, s, m, t):
    """Project the current state onto the constraints and note the largest velocity change; 0 or a negative status."""
    copied(w.u, s.u, s.n_u)
    status = brought_back(s, m, t)
    w.jump = 0.0
    for k in range(s.n_u):
        w.jump = max(w.jump, abs(s.u[k] - w.u[k]))
    return status


@compiled
def counted_anew(w, s, t):
    """Set the revolution counters to the exact angles that they count."""
    if w.n_counted > 0:
        values = evaluate(s, POSITION, t)
        for k in range(w.n_counted):
            s.q[w.counted_row[k]] = values[w.counted_source[k]]


def anew(t, ahead, counted, highest_order, table):
    """Project the current state, move it past simultaneous events, and start IDA; OK or a negative number.

    A negative number means that nothing was started, and Python determines the reason.
    """
    w = anew_view(table)
    b = start_view(w.start)
    m = dynamics_view(b.dynamics)
    s = state_view(m.state)
    c = native_ida_view(ints(b.ida))
    if back_with_jump(w, s, m, t) < 0:
        return int32(UNFINISHED)
    behind = t
    if ahead > 0.0:
        behind += moved_past(s, m, t, ahead, w.n_event_functions, w.q, w.values)
    counted_anew(w, s, behind)
    if accelerated(s, m, behind) < 0 or _beyond_limits(w, s, behind):
        return int32(UNFINISHED)
    if prepared(b, s, m, equations_view(c.equations), c, behind) < 0:
        return int32(UNFINISHED)
    if counted:
        keep_counters(b, c)
    if begun(b, c, behind) < 0:
        return int32(UNFINISHED)
    call_int(b.set_highest_order, (c.memory, int32(highest_order)))
    w.t = behind
    w.meets = _meets(w, s, m, behind) if w.n_event_functions > 0 else 0
    return int32(OK)
