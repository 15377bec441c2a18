"""Start of IDA from consistent values in one call: unknowns, relaxations, Newton tolerance and IDA itself."""

from math import isfinite, sqrt

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
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, MOTION, TANGENT, evaluate, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.dynamics.native.consistent import consistent_accelerations, to_constraints
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.bounds import event_search_view
from stiffmbs.solve.explicit.native.stages import add_trailing_rates
from stiffmbs.solve.ida.native.error_norm import error_norm_view
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.ida.native.iteration import iteration_view
from stiffmbs.solve.ida.native.layouts import START
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.ida.native.parameters import LOOP

NAN = float("nan")

start_view = view_of("Start", START)


@compiled
def _fill_unknowns(w, s, e, y, yp):
    """Fill the unknowns and their derivatives from the current state, and the offsets of dependent coordinates."""
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
def _relax(w, s, t):
    """Set the relaxations of all rows at the current state.

    They are the diagonals of E_mu = eps C_q C_q^T and E_lam = eps J M^-1 J^T, with eps in proportion to the tolerance.
    The drift in tolerances then does not depend on the sizes of lengths, angles, masses and forces.  M is the inertia of
    the heaviest body at an arm as long as the mechanism: light bodies and small moments of inertia may carry its weight.
    """
    if s.n_c == 0:
        return
    values = evaluate(s, MOTION, t)
    for k in range(2 * s.n_c):
        w.relaxations[k] = 0.0
    of_velocities = shifted(w.relaxations, s.n_c)
    for k in range(w.n_position_entries):
        entry = values[w.position_source[k]]
        w.relaxations[w.position_row[k]] += entry * entry
    for k in range(w.n_velocity_entries):
        entry = values[w.velocity_source[k]]
        of_velocities[w.velocity_row[k]] += entry * entry * w.inverse_mass[k]
    for k in range(s.n_c):
        w.relaxations[k] *= w.position_drift
        of_velocities[k] *= w.velocity_drift
    for k in range(w.n_sets):
        if s.values[k] != 0:
            copied(shifted(floats(s.values[k]), w.at_relaxations[k]), w.relaxations, 2 * s.n_c)


@compiled
def _largest_row_sum(w, s, values, count, source, row, scale):
    for k in range(s.n_u):
        w.sums[k] = 0.0
    for k in range(count):
        w.sums[row[k]] += abs(values[source[k]]) / scale[k]
    largest = 0.0
    for k in range(s.n_u):
        if not isfinite(w.sums[k]):
            return w.sums[k]  # for a body of nearly zero mass
        largest = max(largest, w.sums[k])
    return largest


@compiled
def _look_at_stiffness(w, s, t):
    """Store `stiffmbs.solve.error_control.newton.stiffness_at` at the current state."""
    values = evaluate(s, TANGENT, t)
    w.of_positions = _largest_row_sum(w, s, values, w.n_f_q, w.f_q_source, w.f_q_row, w.f_q_scale)
    w.of_velocities = _largest_row_sum(w, s, values, w.n_f_u, w.f_u_source, w.f_u_row, w.f_u_scale)


@compiled
def allow_remainder(w):
    """Set the part of the error tolerance that Newton's iteration may leave: that which causes no significant force."""
    fastest = max(w.of_positions, w.of_velocities * w.of_velocities)
    allowed = w.soft / fastest if fastest > 0.0 else w.loosest
    w.newton = max(min(w.loosest, allowed), w.tightest)


@compiled
def _long_step(w):
    """Return the step size above which states within a step must be corrected; infinite if nothing is stiff."""
    longest = float("inf")
    if w.of_positions > 0.0:
        longest = sqrt(w.amplified / w.of_positions)
    if w.of_velocities > 0.0:
        longest = min(longest, w.amplified / w.of_velocities)
    return longest


@compiled
def _limit(w, c):
    """Set the step above which states within it are corrected, and the residual and imbalance that corrections may leave."""
    correction = output_correction_view(c.output_correction)
    fastest = max(w.of_positions, w.of_velocities * w.of_velocities)
    correction.long = _long_step(w)
    correction.enough = max(w.soft / fastest if fastest > 0.0 else float("inf"), w.least)
    correction.balanced = w.balanced


@compiled
def follow_stiffness(c):
    """Look at the stiffness again if the iteration has a new matrix: forces may have become stiff since the start."""
    correction = output_correction_view(c.output_correction)
    if correction.renewed == 0 or correction.interpolate == 0 or c.starts == 0:
        return
    correction.renewed = 0
    w = start_view(ints(c.starts))
    s = state_view(dynamics_view(w.dynamics).state)
    load(s, equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp))
    _look_at_stiffness(w, s, c.returned)
    _limit(w, c)


@compiled
def begun(w, c, t, highest_order):
    """Start IDA at the prepared unknowns, up to an order, which it cannot lower within a run; OK or a negative flag."""
    call_int(w.set_newton, (c.memory, w.newton))
    flag = call_int(w.reinitialise, (c.memory, t, c.y, c.yp))
    call_int(w.set_first_step, (c.memory, 0.0))
    call_int(w.set_highest_order, (c.memory, int32(highest_order)))
    call_int(w.set_growth, (c.memory, 1.0, w.growth))
    norm = error_norm_view(w.error_norm)
    norm.growth = w.growth
    norm.equal_until = 0
    iteration = iteration_view(c.iteration)
    iteration.cj = float("inf")
    iteration.growth = -1.0
    search = event_search_view(c.watch)
    search.begun = float("inf")
    for k in range(w.n_watched):
        search.found[k] = 0
    for k in range(LOOP.samples * (1 + c.n_reported)):
        c.samples[k] = NAN
    c.returned = t
    c.internal = t
    c.size = 0.0
    c.tiny = 0
    c.since_sample = 0
    return flag


@compiled
def _find_algebraic_rates(w, s, m, t):
    """Find the rates of algebraic states by their values a little later; zero if they have none there."""
    q, u, lam, interval = w.kept, shifted(w.kept, s.n_q), shifted(w.kept, s.n_q + s.n_u), CONSISTENCY.rate_interval
    copied(q, s.q, s.n_q)
    copied(u, s.u, s.n_u)
    copied(lam, s.lam, s.n_c)
    for k in range(s.n_q):
        s.q[k] += interval * w.rate[k]
    take_unit_length(s)
    for k in range(s.n_u):
        s.u[k] += interval * s.a[k]
    found = consistent_accelerations(s, m, t + interval) >= 0
    for k in range(m.n_algebraic):
        found = found and isfinite(s.q[m.algebraic[k]])
    for k in range(m.n_algebraic):
        at = m.algebraic[k]
        w.rate[at] = (s.q[at] - q[at]) / interval if found else 0.0
    copied(s.q, q, s.n_q)
    copied(s.u, u, s.n_u)
    copied(s.lam, lam, s.n_c)


@compiled
def prepare(w, s, m, e, c, t):
    """Prepare a start at the current consistent state, with its accelerations and multipliers.

    The acceleration terms, which hold the rates of coordinates after those of bodies, must be those of this state.
    """
    for k in range(s.n_c):
        s.mu[k] = 0.0
    for k in range(s.n_q):
        w.rate[k] = 0.0
    add_rates(s, s.u, 1.0, w.rate)
    add_trailing_rates(s, m, 1.0, w.rate)
    if m.n_algebraic > 0:
        _find_algebraic_rates(w, s, m, t)
    _relax(w, s, t)
    _look_at_stiffness(w, s, t)
    allow_remainder(w)
    _limit(w, c)
    _fill_unknowns(w, s, e, array_of(c, c.y), array_of(c, c.yp))


@compiled
def keep_counters(w):
    """Add IDA's counters to their sums before a start resets them."""
    add_counters(w.n_counters, w.counter, w.counted, w.count, w.counts)


def start(t, counted, highest_order, table):
    """Start IDA at the consistent values of the state; OK or a negative flag. Its counters are kept if `counted`."""
    w = start_view(table)
    m = dynamics_view(w.dynamics)
    s = state_view(m.state)
    c = native_ida_view(ints(w.ida))
    if m.n_trailing > 0:
        evaluate(s, ACCELERATION, t)
    prepare(w, s, m, equations_view(c.equations), c, t)
    if counted:
        keep_counters(w)
    return int32(begun(w, c, t, highest_order))


def resume(newton, highest_order, table):
    """Start IDA at its current unknowns, with a part of the tolerance for Newton's iteration; OK or a negative flag."""
    w = start_view(table)
    c = native_ida_view(ints(w.ida))
    w.newton = newton
    keep_counters(w)
    return int32(begun(w, c, c.returned, highest_order))


def add_counters(count, functions, arguments, value, sums):
    """Add the results of some counter functions to sums; `value` has space for one number."""
    for k in range(count):
        value[0] = 0  # C's long may be shorter
        call_int(functions[k], (arguments[k], value))
        sums[k] += value[0]


@compiled
def brought_back(s, m, t):
    """Project the current state onto the constraints; 0 or a negative status."""
    if s.n_c == 0:
        return 0
    evaluate(state_view(m.constraining), MOTION, t)
    return min(to_constraints(s, m, t, CONSISTENCY.position_tolerance, CONSISTENCY.most_moves), 0)


@compiled
def accelerated(s, m, t):
    """Compute accelerations and multipliers of the current state; 0 or a negative status."""
    status = consistent_accelerations(s, m, t)
    if status < 0:
        return status
    copied(s.a, factors_view(m.acceleration_factors).b, s.n_u)
    return 0
