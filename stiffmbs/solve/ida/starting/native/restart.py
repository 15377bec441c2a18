"""Restart after a jump of inputs and integration to a later time, in one call."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view, factors_view, ints, state_view, view_of
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import POSITION, evaluate, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK, STOP_RETURN
from stiffmbs.dynamics.native.block_systems import MOST_MOVES
from stiffmbs.dynamics.native.consistent import consistent_accelerations, to_constraints
from stiffmbs.dynamics.native.layouts import POSITION_TOLERANCE
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.ida.native.ida_loop import clear_call, stepped
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.ida.native.layouts import RESTART
from stiffmbs.solve.ida.native.parameters import LOOP
from stiffmbs.solve.ida.starting.native.start import UNFINISHED, begun, prepared, start_view

restart_view = view_of("Restart", RESTART)


@compiled
def brought_back(s, m, t):
    """Project the current state onto the constraints; 0 or a negative status."""
    return to_constraints(s, m, t, POSITION_TOLERANCE, MOST_MOVES) if s.n_c > 0 else 0


@compiled
def accelerated(s, m, t):
    """Compute accelerations and multipliers of the current state; 0 or a negative status."""
    status = consistent_accelerations(s, m, t)
    if status < 0:
        return status
    copied(s.a, factors_view(m.acceleration_factors).b, s.n_u)
    return 0


def restart(t, end, restarts):
    """Integrate from the state in the table at t to `end`, and store the result; return OK.

    Too many steps, an event or a failure give another number, with the state unchanged.
    """
    w = restart_view(restarts)
    b = start_view(w.start)
    m = dynamics_view(b.dynamics)
    s = state_view(m.state)
    ida = ints(b.ida)
    c = native_ida_view(ida)
    e = equations_view(c.equations)
    copied(s.q, w.q, s.n_q)
    copied(s.u, w.u, s.n_u)
    if brought_back(s, m, t) < 0:
        return int32(UNFINISHED)
    if w.n_counted:
        values = evaluate(s, POSITION, t)
        for k in range(w.n_counted):
            s.q[w.counted_row[k]] = values[w.counted_source[k]]
    if accelerated(s, m, t) < 0:
        return int32(UNFINISHED)
    if prepared(b, s, m, e, c, t) < 0 or begun(b, c, t) < 0:
        return int32(UNFINISHED)
    call_int(c.stop_at, (c.memory, end))
    c.stopping = end
    clear_call(c)
    flag = int32(OK)
    for _ in range(LOOP.most_steps):
        if flag != OK:
            break
        flag = stepped(c, ida, end, end)
    if flag != STOP_RETURN:
        return int32(UNFINISHED)
    load(s, e, array_of(c, c.y), array_of(c, c.yp))
    copied(w.q, s.q, s.n_q)
    copied(w.u, s.u, s.n_u)
    return int32(OK)
