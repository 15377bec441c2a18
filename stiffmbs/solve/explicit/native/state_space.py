"""Equations of a mechanism as rates of a state x = (q, u), for programs that integrate or simulate it themselves.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.native.access import compiled, factors_view, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import MOTION, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.dynamics.native.block_systems import (
    largest_open,
    to_accelerations,
    to_position_constraints,
    to_velocity_constraints,
)
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.bounds import event_search_view
from stiffmbs.solve.events.native.values import switches
from stiffmbs.solve.explicit.native.stages import add_trailing_rates, load_state


@compiled
def _projected(s, m, t):
    """Project the current state onto the constraints; 0 or a negative status."""
    take_unit_length(s)
    if s.n_c == 0:
        return 0
    status = to_position_constraints(s, m, t, CONSISTENCY.position_tolerance, CONSISTENCY.most_assembly_moves)
    return status if status < 0 else to_velocity_constraints(s, m, t)


def consistent_rates(t, x, dx, lam, dynamics):
    """Project x onto the constraints, and compute its rates and the multipliers there; 0 or a negative status."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    load_state(s, x)
    status = _projected(s, m, t)
    if status < 0:
        return status
    for i in range(s.n_q):
        dx[i] = 0.0
    add_rates(s, s.u, 1.0, dx)
    status = to_accelerations(s, m, t)
    copied(shifted(dx, s.n_q), factors_view(m.acceleration_factors).b, s.n_u)
    add_trailing_rates(s, m, 1.0, dx)
    copied(x, s.q, s.n_q)
    copied(shifted(x, s.n_q), s.u, s.n_u)
    copied(lam, s.lam, s.n_c)
    return status


def event_functions(t, x, values, watch, dynamics):
    """Compute the event functions at a state, without those of laws."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    load_state(s, x)
    w = event_search_view(watch)
    copied(values, switches(w, s, t), w.n_event_functions)


def violation(t, x, dynamics):
    """Return the largest violation of the constraints at a state, of positions and of velocities."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    if s.n_c == 0:
        return 0.0
    load_state(s, x)
    values = evaluate(s, MOTION, t)
    return max(largest_open(s, values), largest_open(s, shifted(values, s.n_c)))
