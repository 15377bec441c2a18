"""Steps of fixed length with projection: Runge-Kutta schemes, semi-implicit Euler and linearly implicit Euler."""

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, MOTION, POSITION, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.compile.machine.native.statuses import NOT_FINITE
from stiffmbs.dynamics.elimination.native.by_blocks import blocks_view, factor_by_blocks
from stiffmbs.dynamics.elimination.native.eliminated import smallest_move
from stiffmbs.dynamics.native.block_systems import (
    ROUNDING,
    largest_of,
    largest_open,
    to_position_constraints,
    to_velocity_constraints,
)
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.projection import back_to_constraints
from stiffmbs.dynamics.native.views import dynamics_view, eliminated_view
from stiffmbs.solve.events.native.bounds import event_search_view
from stiffmbs.solve.explicit.native.attempt import attempt
from stiffmbs.solve.explicit.native.stages import (
    accelerated,
    add_trailing_rates,
    explicit_view,
    keep_algebraic,
    linear_view,
    load_state,
    rates,
    scheme_view,
)
from stiffmbs.solve.explicit.native.start import start_steps


@compiled
def _begin(x, c, s, m):
    """Start from consistent values; event functions that are zero there decide which rates the first step has."""
    x.rates_known = 0
    copied(s.lam, x.lam, s.n_c)
    if event_search_view(x.watch).n_event_functions > 0 and c.by_stages:
        start_steps(x, c, s, m)
        x.rates_known = 1
    x.started = 1


@compiled
def _runge_kutta(x, c, s, m, h):
    """Compute the new state y of a Runge-Kutta step; 0 or a negative status."""
    if x.rates_known:
        copied(x.k, shifted(x.k, c.stages * x.n), x.n)
    else:
        load_state(s, x.y)
        status = rates(x, s, m, 0, x.t_before)
        if status < 0:
            return status
    return attempt(x, c, s, m, h)


@compiled
def _semi_implicit(x, s, m, h):
    """Compute u += h u', then q += h u; 0 or a negative status."""
    load_state(s, x.y)
    acceleration = shifted(x.k, s.n_q)
    x.accelerations += 1
    status = accelerated(x.eliminates, x.eliminated, s, m, x.t_before, acceleration)
    if status < 0:
        return status
    for k in range(s.n_u):
        s.u[k] += h * acceleration[k]
    add_rates(s, s.u, h, s.q)
    add_trailing_rates(s, m, h, s.q)
    take_unit_length(s)
    _keep(x, s)
    return 0


@compiled
def _linearly_implicit(x, s, h):
    """Take a linearly implicit step; 0 or a negative status.

    Earlier factors are forgotten at a start, unless the solutions by new ones are the same to the last bit.
    """
    load_state(s, x.y)
    if not x.rates_known:
        p = linear_view(x.linear)
        if p.refused[0] != 0 or p.refined[0] != 0:
            ready = p.ready
            ready[0] = 0
    status = call_int(x.linear_step, (x.t_before, h, x.linear))
    _keep(x, s)
    x.rates_known = 1
    return status


@compiled
def _keep(x, s):
    copied(x.y, s.q, s.n_q)
    copied(shifted(x.y, s.n_q), s.u, s.n_u)


@compiled
def _factored(r, m, t):
    """Factor J M^-1 J^T at the current pose; return True if all pivots are accurate."""
    r.ready = factor_by_blocks(r, blocks_view(r.lists), evaluate(state_view(m.constraining), ACCELERATION, t))
    return r.ready


@compiled
def _by_factors(r, s, m, t, tolerance):
    """Move q by the factors of the pose, then u by those of the pose on the constraints; return True if they are satisfied."""
    if not _factored(r, m, t):
        return False
    violations = evaluate(s, POSITION, t)
    close = max(tolerance, ROUNDING * largest_of(s.q, s.n_pose))
    moves = 0
    while not largest_open(s, violations) <= close:
        if moves == CONSISTENCY.most_frozen_moves:
            return False
        smallest_move(r, s, violations)
        add_rates(s, r.a, 1.0, s.q)
        take_unit_length(s)
        violations = evaluate(s, POSITION, t)
        moves += 1
    if moves > 0 and not _factored(r, m, t):
        return False
    violations = evaluate(s, MOTION, t)
    smallest_move(r, s, shifted(violations, s.n_c))
    for k in range(s.n_u):
        s.u[k] += r.a[k]
    return True


@compiled
def _newton_projection(x, s, m, t):
    """Project q and u by Newton's iteration; factors of the step's start would change velocities by an error of second order.

    In space the factors are those of the elimination; in the plane the LU is as fast, and its moves of q have the smallest norm.
    """
    if s.n_c == 0:
        return 0
    if x.eliminates and s.spatial and _by_factors(eliminated_view(x.eliminated), s, m, t, x.tolerance):
        return 0
    status = to_position_constraints(s, m, t, x.tolerance, CONSISTENCY.most_moves)
    return status if status < 0 else to_velocity_constraints(s, m, t)


@compiled
def _arrive(x, c, s, m, t):
    """Project the new state y onto the constraints; 0 or a negative status.

    The rates there are those of the next step's start, which computes them, unless algebraic states follow from them.
    """
    for i in range(x.n):
        if not isfinite(x.y[i]):
            return NOT_FINITE
    load_state(s, x.y)
    if x.project:
        status = back_to_constraints(x, s, m, t) if c.by_stages else _newton_projection(x, s, m, t)
        if status < 0:
            return status
        _keep(x, s)
    x.rates_known = 1 if c.columns > 0 else 0
    if m.n_algebraic > 0 and (c.by_stages or c.columns > 0):
        status = rates(x, s, m, c.stages, t)
        if status < 0:
            return status
        keep_algebraic(s, m, x.y)
        x.rates_known = 1
    return 0


def fixed_steps(start, h, steps, explicit):
    """Take `steps` steps of length h from the time `start`; 0, or a negative status with the state unchanged."""
    x = explicit_view(explicit)
    c, m = scheme_view(x.scheme), dynamics_view(x.dynamics)
    s = state_view(m.state)
    copied(x.y_first, x.y, x.n)
    x.t = start
    if not x.started:
        _begin(x, c, s, m)
    for step in range(steps):
        x.t_before = start + step * h
        copied(x.y_before, x.y, x.n)
        if c.by_stages:
            status = _runge_kutta(x, c, s, m, h)
        else:
            status = _linearly_implicit(x, s, h) if c.columns > 0 else _semi_implicit(x, s, m, h)
        if status == 0:
            status = _arrive(x, c, s, m, start + (step + 1) * h)
        if status < 0:
            copied(x.y, x.y_first, x.n)
            x.rates_known = 0
            return status
    return 0
