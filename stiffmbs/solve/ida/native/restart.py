"""From one instant to another behind a jump of inputs: consistent values, a start of IDA, its steps, all in one call."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import (
    compiled,
    equations_view,
    factors_view,
    floats,
    ints,
    shifted,
    state_view,
    view_of,
)
from stiffmbs.compile.machine.native.evaluate import MOTION, TANGENT, evaluate, load
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.solve.native.calls import call_int, int32
from stiffmbs.solve.native.dynamics import to_accelerations, to_position_constraints, to_velocity_constraints
from stiffmbs.solve.native.error_norm import error_norm_view
from stiffmbs.solve.native.event_search.bounds import event_search_view
from stiffmbs.solve.native.explicit.stages import add_rates_behind, copied
from stiffmbs.solve.native.ida_loop import stepped
from stiffmbs.solve.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.native.iteration import iteration_view
from stiffmbs.solve.native.statuses import OK, STOP_RETURN
from stiffmbs.solve.native.tables.steps import MOST_STEPS, RESTART
from stiffmbs.solve.native.tables.views import dynamics_view

POSITION_TOLERANCE, MOST_MOVES = 1e-12, 50
"""As a start between two pieces of a run has them (`stiffmbs.solve.dynamics.Dynamics.assemble`)."""
UNFINISHED = -1

restart_view = view_of("Restart", RESTART)


@compiled
def _consistent(w, s, m, t):
    """The state at hand on the constraints, with new accelerations, multipliers and rates of coordinates; 0 or a negative status."""
    if s.n_c > 0:
        status = to_position_constraints(s, m, t, POSITION_TOLERANCE, MOST_MOVES)
        if status < 0:
            return status
        status = to_velocity_constraints(s, m, t)
        if status < 0:
            return status
    status = to_accelerations(s, m, t)
    if status < 0:
        return status
    copied(s.a, factors_view(m.acceleration_factors).b, s.n_u)
    for k in range(s.n_c):
        s.mu[k] = 0.0
    for k in range(s.n_q):
        w.rate[k] = 0.0
    add_rates(s, s.u, 1.0, w.rate)
    add_rates_behind(s, m, 1.0, w.rate)
    return 0


@compiled
def _fill_unknowns(w, s, e, y, yp):
    """The unknowns and their derivatives from the state at hand, and the offsets of what moves with others."""
    for k in range(s.n_q):
        leader = w.leader[k]
        e.offset[k] = s.q[k] - (e.q_ratio[k] * s.q[leader] if leader >= 0 else 0.0)
    for k in range(e.n):
        y[k] = 0.0
        yp[k] = 0.0
    for k in range(w.n_q):
        y[w.q_at[k]] = s.q[w.q_of[k]]
        yp[w.q_at[k]] = w.rate[w.q_of[k]]
    for k in range(w.n_u):
        y[w.u_at[k]] = s.u[w.u_of[k]]
        yp[w.u_at[k]] = s.a[w.u_of[k]]
    multipliers = yp if e.integrated else y
    for k in range(s.n_c):
        if e.at_lam[k] >= 0:
            multipliers[e.at_lam[k]] = s.lam[k]


@compiled
def _relax(w, s, e, t):
    """`stiffmbs.solve.error_control.relaxation.relax` at the state at hand."""
    if s.n_c == 0:
        return
    values = evaluate(s, MOTION, t)
    for k in range(2 * s.n_c):
        w.creep[k] = 0.0
    of_velocities = shifted(w.creep, s.n_c)
    for k in range(w.n_position_entries):
        entry = values[w.position_source[k]]
        w.creep[w.position_row[k]] += w.position_creep * entry * entry
    for k in range(w.n_velocity_entries):
        entry = values[w.velocity_source[k]]
        of_velocities[w.velocity_row[k]] += w.velocity_weight[k] * entry * entry
    copied(shifted(floats(s.values[e.residual_set]), w.at_residual), w.creep, 2 * s.n_c)
    copied(shifted(floats(s.values[e.matrix_set]), w.at_matrix), w.creep, 2 * s.n_c)


@compiled
def _largest_row_sum(w, s, values, count, source, row):
    """The largest sum of magnitudes in a row of M^-1 times a matrix."""
    for k in range(s.n_u):
        w.sums[k] = 0.0
    for k in range(count):
        w.sums[row[k]] += abs(values[source[k]])
    largest = 0.0
    for k in range(s.n_u):
        largest = max(largest, w.sums[k] / w.mass[k])
    return largest


@compiled
def _newton(w, s, t):
    """`stiffmbs.solve.error_control.newton.newton_tolerance` at the state at hand."""
    values = evaluate(s, TANGENT, t)
    of_positions = _largest_row_sum(w, s, values, w.n_f_q, w.f_q_source, w.f_q_row)
    of_velocities = _largest_row_sum(w, s, values, w.n_f_u, w.f_u_source, w.f_u_row)
    fastest = max(of_positions, of_velocities * of_velocities)
    allowed = w.soft / fastest if fastest > 0.0 else w.loosest
    return max(min(w.loosest, allowed), w.tightest)


@compiled
def _begin(w, c, t, newton):
    """Start IDA anew, as `stiffmbs.solve.ida.ida.NativeIda.begin` does; OK, or a flag below zero."""
    call_int(w.set_newton, (c.memory, newton))
    flag = call_int(w.start_anew, (c.memory, t, c.y, c.yp))
    call_int(w.set_first_step, (c.memory, 0.0))
    call_int(w.set_growth, (c.memory, 1.0, w.growth))
    norm = error_norm_view(w.error_norm)
    norm.growth = w.growth
    norm.equal_until = 0
    iteration = iteration_view(c.iteration)
    iteration.cj = float("inf")
    iteration.growth = -1.0
    event_search_view(c.watch).ready = 0
    c.returned = t
    c.internal = t
    c.size = 0.0
    c.tiny = 0
    c.since_sample = 0
    return flag


def restart(t, end, restarts):
    """Go from the state in the table at t to another instant, and put the state there into the table; OK, or another number
    with the state as it was: where steps are many, an event is met, or anything fails."""
    w = restart_view(restarts)
    m = dynamics_view(w.dynamics)
    s = state_view(m.state)
    ida = ints(w.ida)
    c = native_ida_view(ida)
    e = equations_view(c.equations)
    copied(s.q, w.q, s.n_q)
    copied(s.u, w.u, s.n_u)
    if _consistent(w, s, m, t) < 0:
        return int32(UNFINISHED)
    _fill_unknowns(w, s, e, array_of(c, c.y), array_of(c, c.yp))
    _relax(w, s, e, t)
    if _begin(w, c, t, _newton(w, s, t)) < 0:
        return int32(UNFINISHED)
    call_int(c.stop_at, (c.memory, end))
    c.stopping = end
    c.served = 0
    c.recorded = 0
    c.traced = 0
    flag = int32(OK)
    for _ in range(MOST_STEPS):
        if flag != OK:
            break
        flag = stepped(c, ida, end, end)
    if flag != STOP_RETURN:
        return int32(UNFINISHED)
    load(s, e, array_of(c, c.y), array_of(c, c.yp))
    copied(w.q, s.q, s.n_q)
    copied(w.u, s.u, s.n_u)
    return int32(OK)
