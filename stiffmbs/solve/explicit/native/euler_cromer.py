"""Semi-implicit Euler steps with projection."""

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled, factors_view, state_view
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.compile.machine.native.statuses import NOT_FINITE
from stiffmbs.dynamics.native.block_systems import to_accelerations, to_position_constraints, to_velocity_constraints
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.explicit.native.stages import add_trailing_rates


@compiled
def _step(s, m, t, h, project, tolerance):
    """Compute u += h u', q += h u, and both projections."""
    status = to_accelerations(s, m, t)
    if status < 0:
        return status
    acceleration = factors_view(m.acceleration_factors).b
    for k in range(s.n_u):
        s.u[k] += h * acceleration[k]
    add_rates(s, s.u, h, s.q)
    add_trailing_rates(s, m, h, s.q)
    take_unit_length(s)
    for k in range(s.n_q):
        if not isfinite(s.q[k]):
            return NOT_FINITE
    if not project:
        return 0
    status = to_position_constraints(s, m, t + h, tolerance, CONSISTENCY.most_moves)
    return status if status < 0 else to_velocity_constraints(s, m, t + h)


def euler_cromer(t, h, steps, project, tolerance, dynamics):
    """Take `steps` steps from the current state; 0 or a negative status."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    for step in range(steps):
        status = _step(s, m, t + step * h, h, project, tolerance)
        if status < 0:
            return status
    return 0
