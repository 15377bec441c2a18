"""Steps of a simulation by fixed steps, each with its own inputs, in one call."""

from stiffmbs.compile.machine.native.access import compiled, factors_view, shifted, state_view
from stiffmbs.dynamics.native.held_inputs import take_inputs
from stiffmbs.dynamics.native.joint_coordinates import follow_joints
from stiffmbs.dynamics.native.views import dynamics_view, eliminated_view, held_inputs_view, joint_coordinates_view
from stiffmbs.solve.explicit.native.fixed_steps import take_steps
from stiffmbs.solve.explicit.native.stages import explicit_view, scheme_view


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


@compiled
def _one(x, start, end, count):
    m = dynamics_view(x.dynamics)
    _forget(x, m)
    return take_steps(x, scheme_view(x.scheme), state_view(m.state), m, start, (end - start) / count, count)


def one_in_loop(start, end, count, explicit):
    """Take one step of a simulation, as `count` steps of the scheme; 0, or a negative status with the state unchanged."""
    return _one(explicit_view(explicit), start, end, count)


def many_in_loop(start, dt, count, n, values, held, joints, explicit):
    """Take n steps of dt, each with a row of inputs; return their number, or after how many of them one has failed.

    The state is then that before the failure, whose status is that of the dynamics.
    """
    x, i, j = explicit_view(explicit), held_inputs_view(held), joint_coordinates_view(joints)
    m = dynamics_view(x.dynamics)
    t = start
    for k in range(n):
        take_inputs(i, shifted(values, k * i.n))
        status = _one(x, t, t + dt, count)
        if status < 0:
            m.status = status
            return k
        t += dt
        follow_joints(j, t, x.y, shifted(x.y, x.n_q))
    return n
