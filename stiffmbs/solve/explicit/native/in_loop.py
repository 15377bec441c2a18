"""Steps of simulations by fixed steps, each with its own inputs, in one call."""

from stiffmbs.compile.machine.native.access import compiled, factors_view, shifted, state_view
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.native.held_inputs import take_inputs
from stiffmbs.dynamics.native.joint_coordinates import follow_joints
from stiffmbs.dynamics.native.views import dynamics_view, eliminated_view, held_inputs_view, joint_coordinates_view
from stiffmbs.solve.events.native.bounds import event_search_view
from stiffmbs.solve.explicit.native.fixed_steps import fixed_steps
from stiffmbs.solve.explicit.native.stages import explicit_view, load_state, rates, scheme_view


@compiled
def _forget(x, m):
    """Discard rates and pivots of earlier states, so that a step depends on time, state and inputs alone."""
    x.rates_known = 0
    positions, velocities = factors_view(m.position_factors), factors_view(m.velocity_factors)
    accelerations = factors_view(m.acceleration_factors)
    positions.ready, velocities.ready, accelerations.ready = 0, 0, 0
    if x.eliminates:
        r = eliminated_view(x.eliminated)
        r.most_kept = 0.0
        for k in range(r.n_scales):
            r.largest_scale[k] = 0.0


def one_in_loop(start, end, count, explicit):
    """Take one step of a simulation, as `count` steps of the scheme; 0, or a negative status with the state unchanged."""
    x = explicit_view(explicit)
    _forget(x, dynamics_view(x.dynamics))
    return fixed_steps(start, (end - start) / count, count, explicit)


def many_in_loop(start, dt, count, n, values, held, joints, explicit):
    """Take n steps of dt, each with a row of inputs; return their number, or after how many of them one has failed.

    The state is then that before the failure, whose status is that of the dynamics.
    """
    x, i, j = explicit_view(explicit), held_inputs_view(held), joint_coordinates_view(joints)
    m = dynamics_view(x.dynamics)
    t = start
    for k in range(n):
        take_inputs(i, shifted(values, k * i.n))
        status = one_in_loop(t, t + dt, count, explicit)
        if status < 0:
            m.status = status
            return k
        t += dt
        follow_joints(j, t, x.y, shifted(x.y, x.n_q))
    return n


@compiled
def _begin_at_zeros(x, t):
    """Compute the rates of a state, for a first step that begins where event functions may be zero."""
    c, m = scheme_view(x.scheme), dynamics_view(x.dynamics)
    s = state_view(m.state)
    if event_search_view(x.watch).n_event_functions > 0 and c.by_stages:
        _forget(x, m)
        load_state(s, x.y)
        x.t = t
        if rates(x, s, m, c.stages, t) == 0:
            copied(x.lam, s.lam, s.n_c)
            x.started = 0


def each_in_loop(dt, count, n, times, states, values, coordinates, rates, statuses, held, joints, explicit):
    """Take one step of dt from each of n states (q, u), with times, rows of inputs and coordinates of joints of their own.

    A state without a step, whose status is negative, is not changed.
    """
    x, i, j = explicit_view(explicit), held_inputs_view(held), joint_coordinates_view(joints)
    for k in range(n):
        state, coordinate, rate = shifted(states, k * x.n), shifted(coordinates, k * j.n), shifted(rates, k * j.n)
        copied(x.y, state, x.n)
        take_inputs(i, shifted(values, k * i.n))
        _begin_at_zeros(x, times[k])
        statuses[k] = one_in_loop(times[k], times[k] + dt, count, explicit)
        if statuses[k] == 0:
            j.t = times[k]
            copied(j.coordinate, coordinate, j.n)
            copied(j.rate, rate, j.n)
            times[k] += dt
            copied(state, x.y, x.n)
            follow_joints(j, times[k], x.y, shifted(x.y, x.n_q))
            copied(coordinate, j.coordinate, j.n)
            copied(rate, j.rate, j.n)
