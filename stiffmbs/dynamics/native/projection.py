"""Projection of an integrator's steps onto the constraints, by frozen factors if possible, or by Newton's iteration."""

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.evaluate import MOTION, POSITION, evaluate
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.dynamics.elimination.native.eliminated import smallest_move
from stiffmbs.dynamics.native.block_systems import (
    ROUNDING,
    largest_of,
    largest_open,
    to_position_constraints,
    to_velocity_constraints,
)
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import eliminated_view


@compiled
def _by_frozen_factors(r, s, t, tolerance):
    """Move q and u by the factors of the last accelerations; return True if the constraints are satisfied.

    Velocities need one move: the remaining violation is as small as the change of J.
    """
    violations = evaluate(s, POSITION, t)
    close = max(tolerance, ROUNDING * largest_of(s.q, s.n_pose))
    for _ in range(CONSISTENCY.most_frozen_moves):
        if largest_open(s, violations) > close:
            smallest_move(r, s, violations)
            add_rates(s, r.a, 1.0, s.q)
        violations = evaluate(s, MOTION, t)
        if largest_open(s, violations) <= close:
            smallest_move(r, s, shifted(violations, s.n_c))
            for k in range(s.n_u):
                s.u[k] += r.a[k]
            take_unit_length(s)
            return True
    return False


@compiled
def back_to_constraints(x, s, m, t):
    """Project q and u of the current state, the end of a step, onto the constraints; 0 or a negative status."""
    if s.n_c == 0:
        take_unit_length(s)
        return 0
    if x.eliminates:
        r = eliminated_view(x.eliminated)
        if r.ready and _by_frozen_factors(r, s, t, x.tolerance):
            return 0
    status = to_position_constraints(s, m, t, x.tolerance, CONSISTENCY.most_moves)
    return status if status < 0 else to_velocity_constraints(s, m, t)
