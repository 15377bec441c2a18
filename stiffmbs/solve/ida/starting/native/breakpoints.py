"""Integration over breakpoints in one call: IDA restarts at each that requires only consistent values."""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, equations_view, state_view
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import load
from stiffmbs.compile.machine.native.statuses import STOP_RETURN
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.ida.native.ida_loop import advanced, clear_call
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.ida.native.parameters import LOOP
from stiffmbs.solve.ida.starting.native.after_event import anew_view, back_with_jump, counted_anew
from stiffmbs.solve.ida.starting.native.restart import accelerated
from stiffmbs.solve.ida.starting.native.start import UNFINISHED, begun, keep_counters, prepared, start_view


@compiled
def _long_step(w, b):
    """Return `stiffmbs.solve.error_control.newton.Stiffness.long_step` at the last start."""
    longest = float("inf")
    if b.of_positions > 0.0:
        longest = sqrt(w.amplified / b.of_positions)
    if b.of_velocities > 0.0:
        longest = min(longest, w.amplified / b.of_velocities)
    return longest


@compiled
def _limit(w, b, c):
    """Set the step above which states within it are corrected, and the residual allowed after the correction."""
    correction = output_correction_view(c.output_correction)
    fastest = max(b.of_positions, b.of_velocities * b.of_velocities)
    correction.long = _long_step(w, b)
    correction.enough = max(b.soft / fastest if fastest > 0.0 else float("inf"), w.least)


@compiled
def _take_state(s, b, e, y, yp):
    """Load the state from the unknowns; constant coordinates are as at the last start."""
    for k in range(s.n_q):
        if b.leader[k] < 0:
            s.q[k] = e.offset[k]
    for k in range(s.n_u):
        s.u[k] = 0.0
    load(s, e, y, yp)


@compiled
def _same_offsets(s, b, e):
    """Return True if dependent coordinates keep the offsets of the last start, used for all rows of a call."""
    others = 0
    for k in range(s.n_q):
        leader = b.leader[k]
        others += e.offset[k] != s.q[k] - (e.q_ratio[k] * s.q[leader] if leader >= 0 else 0.0)
    return others == 0


@compiled
def _started_behind(w, b, c, t):
    """Restart at t from IDA's current state; a negative number, with IDA unchanged, leaves the restart to Python."""
    m = dynamics_view(b.dynamics)
    s = state_view(m.state)
    e = equations_view(c.equations)
    _take_state(s, b, e, array_of(c, c.y), array_of(c, c.yp))
    if back_with_jump(w, s, m, t) < 0 or w.jump > w.largest_jump:
        return UNFINISHED
    counted_anew(w, s, t)
    if not _same_offsets(s, b, e):
        return UNFINISHED
    if accelerated(s, m, t) < 0 or prepared(b, s, m, e, c, t) < 0:
        return UNFINISHED
    _limit(w, b, c)
    keep_counters(b, c)
    return begun(b, c, t)


def advance_past(count, times, n_stops, stops, most, highest_order, y_out, table, ida):
    """Integrate by at most `most` steps to each stop, restart after all but the last; return IDA's last flag.

    Returns at a stop that Python has to handle; the table holds the number of stops passed.
    """
    w = anew_view(table)
    b = start_view(w.start)
    c = native_ida_view(ida)
    clear_call(c)
    w.passed = 0
    w.steps_before = 0
    while True:
        stop = stops[w.passed]
        flag = call_int(c.stop_at, (c.memory, stop))
        if flag < 0:
            return int32(flag)
        flag = advanced(c, ida, count, times, stop, most, y_out, 0)
        if flag != STOP_RETURN or w.passed + 1 == n_stops or c.recorded + most > 2 * LOOP.most_steps:
            return int32(flag)
        t = c.returned + w.indistinct * abs(c.returned)
        same = t + w.indistinct * abs(t)
        if same >= stops[w.passed + 1] or (c.served < count and times[c.served] <= same):
            return int32(flag)
        if _started_behind(w, b, c, t) < 0:
            return int32(flag)
        call_int(b.set_highest_order, (c.memory, int32(highest_order)))
        w.t = t
        w.passed += 1
        w.steps_before = c.recorded
