"""Solution of the block systems of a mechanism: projections of positions and velocities, accelerations."""

from math import isfinite
from sys import float_info

from stiffmbs.compile.machine.native.access import compiled, equations_view, factors_view
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, MOTION, POSITION, add_entries, add_products, evaluate
from stiffmbs.compile.machine.native.factors import DONE, FULL, factored, solve
from stiffmbs.compile.machine.native.orientation import take_unit_length
from stiffmbs.compile.machine.native.statuses import (
    NO_BALANCE,
    NO_CONVERGENCE,
    NO_MEMORY,
    NO_STATE,
    NOT_FINITE,
    SINGULAR,
)
from stiffmbs.dynamics.native.parameters import CONSISTENCY

ROUNDING = 4 * float_info.epsilon
"""Smallest detectable violation relative to the largest coordinate or velocity: four roundings."""
ENTRY_ROUNDING = ROUNDING / 2
"""Difference of two entries in block matrices with unit diagonal that is rounding: two roundings of 1."""


@compiled
def largest_of(values, count):
    """Return the largest magnitude; infinity if a number is not finite."""
    largest = 0.0
    for k in range(count):
        if not isfinite(values[k]):
            return float("inf")
        largest = max(largest, abs(values[k]))
    return largest


@compiled
def largest_open(s, violation):
    """Return the largest position violation beyond the tolerances of redundant equations."""
    largest = 0.0
    for row in range(s.n_c):
        if not isfinite(violation[row]):
            return float("inf")
        largest = max(largest, abs(violation[row]) - s.left_open[row])
    return largest


@compiled
def _is_as_factored(f):
    """Return True if the matrix equals the factored one, as for velocities at the same pose.

    Term sets round the same terms differently: entries may differ by rounding of the scaled matrix.
    """
    for column in range(f.n):
        for p in range(f.a_start[column], f.a_start[column + 1]):
            scale = f.scale[f.a_row[p]] * f.scale[column]
            if not (f.a[p] == f.factored[p] or abs(f.a[p] - f.factored[p]) * scale <= ENTRY_ROUNDING):
                return False
    return True


@compiled
def _solved(s, equations, factors, values):
    """Assemble, factor and solve a block system; 0, with the solution in the factors' `b`, or a negative status."""
    e = equations_view(equations)
    matrix = factors_view(factors)
    add_entries(e, values, 0.0, matrix.a)
    if not (matrix.ready and _is_as_factored(matrix)):
        for k in range(matrix.a_start[matrix.n]):
            matrix.factored[k] = matrix.a[k]
        outcome = factored(factors)
        if outcome == FULL:
            return NO_MEMORY
        if outcome != DONE:
            return SINGULAR if isfinite(largest_of(matrix.a, matrix.a_start[matrix.n])) else NOT_FINITE
    f = factors_view(factors)  # the memory may have grown
    add_products(e, values, f.previous, f.previous, f.b)
    solve(f, f.b)
    return 0 if isfinite(largest_of(f.b, f.n)) else NOT_FINITE


@compiled
def to_position_constraints(s, m, t, tolerance, most):
    """Take minimum-norm Newton steps until |C| <= tolerance, or rounding; return their number or a negative status."""
    for move in range(most):
        values = evaluate(s, POSITION, t)
        violation = largest_open(s, values)
        if violation <= max(tolerance, ROUNDING * largest_of(s.q, s.n_pose)):
            return move
        if not isfinite(violation):
            return NOT_FINITE
        status = _solved(s, m.positions, m.position_factors, values)
        if status < 0:
            return status
        step = factors_view(m.position_factors).b
        for k in range(s.n_q):
            s.q[k] += step[k]
        take_unit_length(s)
    return NO_CONVERGENCE


@compiled
def to_velocity_constraints(s, m, t):
    """Correct u so that J u + C_t = 0, with minimum norm in the mass matrix; return 0 or a negative status."""
    values = evaluate(s, MOTION, t)
    status = _solved(s, m.velocities, m.velocity_factors, values)
    if status < 0:
        return status
    step = factors_view(m.velocity_factors).b
    for k in range(s.n_u):
        s.u[k] += step[k]
    return 0


@compiled
def _largest_force(s, e, values):
    """Return the largest applied force, the scale below which multipliers are negligible."""
    largest = 0.0
    for k in range(e.n_plain):
        if e.r_row[k] < s.n_u:
            largest = max(largest, abs(values[e.r_source[k]]))
    return largest


@compiled
def _algebraic_moved(s, m, e, f):
    """Update the algebraic states; return their largest change, relative to values or scales."""
    moved = 0.0
    for k in range(m.n_algebraic):
        place = m.algebraic[k]
        new = f.b[e.at_x[place]]
        moved = max(moved, abs(new - s.q[place]) / max(abs(new), m.algebraic_scale[k]))
        s.q[place] = new
    return moved


@compiled
def _algebraic_back(s, m, status):
    """Restore the algebraic states after a failed iteration; return the status."""
    for k in range(m.n_algebraic):
        s.q[m.algebraic[k]] = m.algebraic_before[k]
    return NO_STATE if m.n_algebraic > 0 and status != NO_MEMORY else status


@compiled
def to_accelerations(s, m, t):
    """Compute accelerations (in the factors' `b`), multipliers (in lam) and algebraic states (in q).

    One linear solution, or Newton's iteration from the current values if algebraic states or lam affect forces.
    """
    e = equations_view(m.accelerations)
    f = factors_view(m.acceleration_factors)
    iterated = e.n_with_y > e.n_plain
    for k in range(m.n_algebraic):
        m.algebraic_before[k] = s.q[m.algebraic[k]]
    moved = 0.0
    for _ in range(CONSISTENCY.most_iterations):
        for k in range(s.n_c):
            if e.at_lam[k] >= 0:
                f.previous[e.at_lam[k]] = s.lam[k]
        for k in range(m.n_algebraic):
            f.previous[e.at_x[m.algebraic[k]]] = s.q[m.algebraic[k]]
        values = evaluate(s, ACCELERATION, t)
        status = _solved(s, m.accelerations, m.acceleration_factors, values)
        if status < 0:
            if status == NOT_FINITE:  # no start of the next iteration, at another state
                for k in range(s.n_c):
                    s.lam[k] = 0.0
            return _algebraic_back(s, m, NO_BALANCE if iterated and status == SINGULAR else status)
        before = moved
        moved = _algebraic_moved(s, m, e, f)
        found = moved <= CONSISTENCY.position_tolerance or (
            moved <= CONSISTENCY.state_rounded_off and moved >= CONSISTENCY.slow * before
        )
        change = 0.0
        largest = _largest_force(s, e, values) if iterated else 0.0
        for k in range(s.n_c):
            new = f.b[e.at_lam[k]] if e.at_lam[k] >= 0 else 0.0
            change = max(change, abs(new - s.lam[k]))
            largest = max(largest, abs(new))
            s.lam[k] = new
        if not iterated or (found and change <= CONSISTENCY.converged * largest):
            if m.by_reactions:
                evaluate(s, ACCELERATION, t)
            return 0
    return 0 if found and change <= CONSISTENCY.rounded_off * largest else _algebraic_back(s, m, NO_BALANCE)
