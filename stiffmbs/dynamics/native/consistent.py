"""Projection of states near the constraints, by elimination of velocities if accurate, otherwise by the whole LU.

The factors of the elimination belong to the pose before the projection.  Moves with them converge also nearby, for
positions and velocities; both violations are checked again.
"""

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, shifted, state_view
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, MOTION, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.dynamics.native.block_systems import (
    ROUNDING,
    largest_of,
    largest_open,
    to_accelerations,
    to_position_constraints,
    to_velocity_constraints,
)
from stiffmbs.dynamics.native.parameters import CONSISTENCY, ELIMINATION
from stiffmbs.dynamics.native.views import eliminated_view


@compiled
def _eliminated(s, m, t):
    """Compute accelerations (in the factors' `b`) and multipliers (in lam) by elimination; True if accurate."""
    if not m.eliminates:
        return False
    r = eliminated_view(m.eliminated)
    return (
        call_int(r.attempt, (t, factors_view(m.acceleration_factors).b, m.eliminated)) != 0
        and r.kept >= ELIMINATION.kept
    )


@compiled
def _satisfy_joints(s, m):
    """Return True if accelerations by elimination satisfy J u' = gamma as accurately as those of the LU."""
    r, acceleration = eliminated_view(m.eliminated), factors_view(m.acceleration_factors).b
    values = floats(s.values[ACCELERATION])
    for row in range(s.n_c):
        r.left[row] = 0.0
        r.sizes[row] = 0.0
    for k in range(r.n_gamma):
        part = values[r.gamma_source[k]]
        r.left[r.gamma_row[k]] += part
        r.sizes[r.gamma_row[k]] += abs(part)
    for k in range(r.n_j):
        part = values[r.j_source[k]] * acceleration[r.j_column[k]]
        r.left[r.j_row[k]] -= part
        r.sizes[r.j_row[k]] += abs(part)
    beyond = 0
    for row in range(s.n_c):
        beyond += 0 if abs(r.left[row]) <= ELIMINATION.residual * r.sizes[row] + r.least else 1  # also for NaN
    return beyond == 0


@compiled
def consistent_accelerations(s, m, t):
    """Compute `stiffmbs.dynamics.native.block_systems.to_accelerations`, by elimination if possible; note the method."""
    m.by_elimination = 1 if _eliminated(s, m, t) and _satisfy_joints(s, m) else 0
    if not m.by_elimination:
        return to_accelerations(s, m, t)
    if m.by_reactions:
        evaluate(s, ACCELERATION, t)
    return 0


@compiled
def _are_closed(s, violations, tolerance):
    """Return True if the violations of positions and velocities are within a tolerance, or rounding."""
    of_positions = max(tolerance, ROUNDING * largest_of(s.q, s.n_pose))
    of_velocities = max(tolerance, ROUNDING * largest_of(s.u, s.n_u))
    return largest_open(s, violations) <= of_positions and largest_open(s, shifted(violations, s.n_c)) <= of_velocities


@compiled
def _factored(m, t):
    """Factor J M^-1 J^T at the current pose; return True if output rows may use the factors."""
    r = eliminated_view(m.eliminated)
    return call_int(r.factor, (t, m.constraining, m.eliminated)) != 0 and r.kept >= ELIMINATION.kept


@compiled
def _closed(r, s, m, t, tolerance):
    """Project q and u onto the constraints with the current factors; return True if that converges.

    The constraint terms of the set ``motion`` must be those of the state, and are then those of the result. Each move must
    reduce the violation to a part `contraction`, so that moves by the factors of another pose are close to those of smallest norm.
    """
    joints = state_view(m.constraining)
    violations = floats(s.values[MOTION])
    close = max(tolerance, ROUNDING * largest_of(s.q, s.n_pose))
    for _ in range(CONSISTENCY.most_frozen_moves):
        before = largest_open(s, violations)
        if before > close:
            call_int(r.move, (violations, m.eliminated))
            add_rates(s, r.a, 1.0, s.q)
            take_unit_length(s)
            violations = evaluate(joints, MOTION, t)
            if not largest_open(s, violations) <= max(close, CONSISTENCY.contraction * before):
                return False
    if largest_open(s, violations) > close:
        return False
    close = max(tolerance, ROUNDING * largest_of(s.u, s.n_u))
    for _ in range(CONSISTENCY.most_frozen_moves):
        before = largest_open(s, shifted(violations, s.n_c))
        if before > close:
            call_int(r.move, (shifted(violations, s.n_c), m.eliminated))
            for k in range(s.n_u):
                s.u[k] += r.a[k]
            violations = evaluate(joints, MOTION, t)
            if not largest_open(s, shifted(violations, s.n_c)) <= max(close, CONSISTENCY.contraction * before):
                return False
    return largest_open(s, shifted(violations, s.n_c)) <= close


@compiled
def _closed_or_as_before(r, s, m, t, tolerance):
    """Project as `_closed`; return False, with q and u unchanged, if that does not converge."""
    copied(r.q_before, s.q, s.n_q)
    copied(r.u_before, s.u, s.n_u)
    if _closed(r, s, m, t, tolerance):
        return True
    copied(s.q, r.q_before, s.n_q)
    copied(s.u, r.u_before, s.n_u)
    return False


@compiled
def to_constraints(s, m, t, tolerance, most):
    """Project q and u of a state near the constraints, for which the constraint terms of the set ``motion`` were computed.

    Return 1 if these terms are those of the result, 0 if not, or a negative status.
    """
    if m.eliminates:
        if _are_closed(s, floats(s.values[MOTION]), tolerance):
            return 1
        if _factored(m, t) and _closed_or_as_before(eliminated_view(m.eliminated), s, m, t, tolerance):
            return 1
    status = to_position_constraints(s, m, t, tolerance, most)
    return status if status < 0 else to_velocity_constraints(s, m, t)
