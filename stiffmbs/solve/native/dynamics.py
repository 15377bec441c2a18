"""Assembly, projections and accelerations at the state of a system, and what is reported of it."""

from __future__ import annotations

from math import isfinite, sqrt

from stiffmbs.compile.machine.native.access import compiled, equations_view, factors_view, floats, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import (
    ACCELERATION,
    MOTION,
    OUTPUT,
    POSITION,
    add_entries,
    add_products,
    call_kernels,
    evaluate,
    share_turns,
)
from stiffmbs.compile.machine.native.factors import DONE, FULL, factored, log_determinant, solve
from stiffmbs.compile.machine.native.orientation import take_unit_length
from stiffmbs.solve.native.long_steps import contradicts
from stiffmbs.solve.native.statuses import NO_BALANCE, NO_CONVERGENCE, NO_MEMORY, NO_STATE, NOT_FINITE, SINGULAR
from stiffmbs.solve.native.tables.views import dynamics_view

MOST_MOVES = 20
"""Newton's moves back to the constraints, from a state that was near them."""
COORDINATE_ROUNDING = 9e-16
"""Part of the largest coordinate that no violation can be told below: four roundings."""
ENTRY_ROUNDING = 4.4e-16
"""Difference of two entries of block matrices, scaled to a diagonal of 1, that is none: two roundings of 1."""
MOST_FRICTION_ITERATIONS = 40
FRICTION_TOLERANCE = 1e-13
"""Change of the multipliers, relative to the largest of them and of the applied forces, at which they are in balance with the friction that they press."""
AMPLIFIED, MOVED = 1e6, 1e-6
"""Times a violation, and part of the largest coordinate, that a projection of an output may move a coordinate: beyond that the
pose is singular to rounding, which then decides where the projection leads."""
ROUNDED_OFF = 1e-9
"""Change that is taken for balance all the same when no iteration brings it further down."""
STATE_TOLERANCE, STATE_ROUNDED_OFF, SLOW = 1e-12, 1e-7, 0.25
"""Change of algebraic states, relative to their values or scales, at which Newton's iteration has found them; and the one that
will do where a move is no shorter than this part of the one before."""


@compiled
def largest_of(values, count):
    """The largest magnitude; infinity where a number is not finite."""
    largest = 0.0
    for k in range(count):
        if not isfinite(values[k]):
            return float("inf")
        largest = max(largest, abs(values[k]))
    return largest


@compiled
def largest_open(s, violation):
    """The largest violation of positions beyond what redundant equations may be off by."""
    largest = 0.0
    for row in range(s.n_c):
        if not isfinite(violation[row]):
            return float("inf")
        largest = max(largest, abs(violation[row]) - s.left_open[row])
    return largest


@compiled
def _largest_violation(s, violation):
    """The largest violation of a joint: the norm over its equations (for a pin the distance of its two points)."""
    largest = 0.0
    for joint in range(s.n_joints):
        total = 0.0
        for row in range(s.joint_start[joint], s.joint_start[joint + 1]):
            total += violation[row] * violation[row]
        largest = max(largest, total)
    return sqrt(largest)


@compiled
def _is_as_factored(f):
    """Whether the matrix is the one whose factors are known, as of velocities at the same pose, or of bodies without joints.

    Term sets round the same terms in different ways: entries may differ by what they lose in the scaled matrix anyway.
    """
    for column in range(f.n):
        for p in range(f.a_start[column], f.a_start[column + 1]):
            if f.a[p] != f.factored[p] and not _rounded_alike(f, p, column):
                return False
    return True


@compiled
def _rounded_alike(f, p, column):
    """Whether an entry is by rounding alone another one than that whose factors are known."""
    return abs(f.a[p] - f.factored[p]) * f.scale[f.a_row[p]] * f.scale[column] <= ENTRY_ROUNDING


@compiled
def _solved(s, equations, factors, values):
    """Fill in, factor and solve one block system; 0, with the solution in the factors' `b`, or a failure."""
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
    """Newton's smallest moves until |C| <= tolerance, or rounding; the number of moves, or a negative status."""
    for move in range(most):
        values = evaluate(s, POSITION, t)
        violation = largest_open(s, values)
        if violation <= max(tolerance, COORDINATE_ROUNDING * largest_of(s.q, s.n_pose)):
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
    """The smallest correction of u in the mass matrix that brings J u + C_t to zero."""
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
    """The largest applied force: multipliers that vanish beside it need no digits of their own."""
    largest = 0.0
    for k in range(e.n_plain):
        if e.r_row[k] < s.n_u:
            largest = max(largest, abs(values[e.r_source[k]]))
    return largest


@compiled
def _algebraic_moved(s, m, e, f):
    """Take over the new values of algebraic states; their largest change, relative to values or scales."""
    moved = 0.0
    for k in range(m.n_algebraic):
        place = m.algebraic[k]
        new = f.b[e.at_x[place]]
        moved = max(moved, abs(new - s.q[place]) / max(abs(new), m.algebraic_scale[k]))
        s.q[place] = new
    return moved


@compiled
def _algebraic_back(s, m, status):
    """The algebraic states as they were before an iteration that has failed, and why it has."""
    for k in range(m.n_algebraic):
        s.q[m.algebraic[k]] = m.algebraic_before[k]
    return NO_STATE if m.n_algebraic > 0 and status != NO_MEMORY else status


@compiled
def to_accelerations(s, m, t):
    """Accelerations (in the factors' `b`), multipliers (in lam) and algebraic states (in q) at the current state.

    One linear solution; Newton's iteration from the values at hand where there are algebraic states, or forces hang on lam.
    """
    e = equations_view(m.accelerations)
    f = factors_view(m.acceleration_factors)
    iterated = e.n_with_y > e.n_plain
    for k in range(m.n_algebraic):
        m.algebraic_before[k] = s.q[m.algebraic[k]]
    moved = 0.0
    for _ in range(MOST_FRICTION_ITERATIONS):
        for k in range(s.n_c):
            if e.at_lam[k] >= 0:
                f.previous[e.at_lam[k]] = s.lam[k]
        for k in range(m.n_algebraic):
            f.previous[e.at_x[m.algebraic[k]]] = s.q[m.algebraic[k]]
        values = evaluate(s, ACCELERATION, t)
        status = _solved(s, m.accelerations, m.acceleration_factors, values)
        if status < 0:
            return _algebraic_back(s, m, NO_BALANCE if iterated and status == SINGULAR else status)
        before = moved
        moved = _algebraic_moved(s, m, e, f)
        found = moved <= STATE_TOLERANCE or (moved <= STATE_ROUNDED_OFF and moved >= SLOW * before)
        change = 0.0
        largest = _largest_force(s, e, values) if iterated else 0.0
        for k in range(s.n_c):
            new = f.b[e.at_lam[k]] if e.at_lam[k] >= 0 else 0.0
            change = max(change, abs(new - s.lam[k]))
            largest = max(largest, abs(new))
            s.lam[k] = new
        if not iterated or (found and change <= FRICTION_TOLERANCE * largest):
            if m.by_reactions:
                evaluate(s, ACCELERATION, t)
            return 0
    return 0 if found and change <= ROUNDED_OFF * largest else _algebraic_back(s, m, NO_BALANCE)


def assemble(t, tolerance, most, dynamics):
    """`to_position_constraints` from Python."""
    m = dynamics_view(dynamics)
    return to_position_constraints(state_view(m.state), m, t, tolerance, most)


def correct_velocities(t, dynamics):
    """`to_velocity_constraints` from Python."""
    m = dynamics_view(dynamics)
    return to_velocity_constraints(state_view(m.state), m, t)


def accelerate(t, acceleration, dynamics):
    """`to_accelerations` from Python; accelerations are copied out."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    status = to_accelerations(s, m, t)
    for k in range(s.n_u):
        acceleration[k] = factors_view(m.acceleration_factors).b[k]
    return status


def contradicting(count, begin, end, apart, q, u, mass, rtol, atol, part, tolerances, rate, found, dynamics):
    """Which of `count` steps have accelerations in their middle that contradict their polynomial; how many.

    States (n_q, n_u numbers) are given twice a step, so far apart as a part of it on both sides of its middle; `rate` is memory.
    Where accelerations have no solution they contradict.
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    total = 0
    for step in range(count):
        h = end[step] - begin[step]
        first, second = shifted(q, 2 * step * s.n_q), shifted(q, (2 * step + 1) * s.n_q)
        for k in range(s.n_q):
            s.q[k] = 0.5 * (first[k] + second[k])
        first, second = shifted(u, 2 * step * s.n_u), shifted(u, (2 * step + 1) * s.n_u)
        for k in range(s.n_u):
            s.u[k] = 0.5 * (first[k] + second[k])
            rate[k] = (second[k] - first[k]) / (2.0 * apart * h)
        solved = to_accelerations(s, m, 0.5 * (begin[step] + end[step])) >= 0
        acceleration = factors_view(m.acceleration_factors).b
        found[step] = 0
        if not solved or contradicts(h, acceleration, rate, s.u, mass, rtol, atol, part, tolerances, s.n_u):
            found[step] = 1
            total += 1
    return total


@compiled
def _led_astray(s, q, violation):
    """Whether a projection has moved a coordinate from q by far more than the violation asks for."""
    moved = 0.0
    for k in range(s.n_q):
        moved = max(moved, abs(s.q[k] - q[k]))
    return moved > AMPLIFIED * violation and moved > MOVED * largest_of(s.q, s.n_q)


@compiled
def _output_point(s, m, t, q, project, tolerance, largest):
    """Bring the state, from coordinates q, back to the constraints where asked, then accelerations, multipliers and output terms."""
    for k in range(3):
        largest[k] = 0.0
    take_unit_length(s)
    for k in range(s.n_q):
        q[k] = s.q[k]
    if project and s.n_c > 0:
        largest[2] = _largest_violation(s, evaluate(s, POSITION, t))
        status = to_position_constraints(s, m, t, tolerance, MOST_MOVES)
        if status < 0:
            return status
        if _led_astray(s, q, largest[2]):
            return SINGULAR
        status = to_velocity_constraints(s, m, t)
        if status < 0:
            return status
    if s.n_c > 0:
        values = evaluate(s, MOTION, t)
        largest[0] = _largest_violation(s, values)
        largest[1] = _largest_violation(s, shifted(values, s.n_c))
    status = to_accelerations(s, m, t)
    if status < 0:
        return status
    share_turns(s, m.turned_for_output, m.n_turned_for_output)  # the others stand since the accelerations
    call_kernels(s, OUTPUT, t)
    return 0


def output_points(count, times, project, tolerance, n_output, q, u, acceleration, lam, output, judged, dynamics):
    """Everything that is reported at `count` instants, row by row; the number of rows done.

    q and u (rows of n_q, n_u) are brought back to the constraints where `project` asks for it; written are u', lam,
    the values of the output terms, and in `judged` four numbers a row: the violations of positions and of
    velocities (largest of a joint), of positions before the projection, and log |det| of the block matrix.  Where an
    instant has no solution, the dynamics' `status` holds why.
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    for row in range(count):
        at_row = shifted(q, row * s.n_q)
        for k in range(s.n_q):
            s.q[k] = at_row[k]
        for k in range(s.n_u):
            s.u[k] = u[row * s.n_u + k]
        m.status = _output_point(s, m, times[row], at_row, project, tolerance, shifted(judged, 4 * row))
        if m.status < 0:
            return row
        factors = factors_view(m.acceleration_factors)
        judged[4 * row + 3] = log_determinant(factors)
        solution = factors.b
        values = floats(s.values[OUTPUT])
        for k in range(s.n_q):
            at_row[k] = s.q[k]
        for k in range(s.n_u):
            u[row * s.n_u + k] = s.u[k]
            acceleration[row * s.n_u + k] = solution[k]
        for k in range(s.n_c):
            lam[row * s.n_c + k] = s.lam[k]
        for k in range(n_output):
            output[row * n_output + k] = values[k]
    return count
