"""Dynamics of a state for Python: assembly, projections, accelerations and output rows."""

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, MOTION, OUTPUT, call_kernels, evaluate, share_turns
from stiffmbs.compile.machine.native.factors import DONE, equilibrate, factor, log_determinant, scale, solve
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import take_unit_length
from stiffmbs.compile.machine.native.statuses import SINGULAR
from stiffmbs.dynamics.elimination.native.eliminated import log_determinant_by_blocks
from stiffmbs.dynamics.native.block_systems import (
    largest_of,
    to_accelerations,
    to_position_constraints,
    to_velocity_constraints,
)
from stiffmbs.dynamics.native.consistent import consistent_accelerations, to_constraints
from stiffmbs.dynamics.native.layouts import JUDGED, LINES
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import dynamics_view, eliminated_view

N_JUDGED = len(JUDGED)
GAP, GAP_RATE, DRIFT, DETERMINANT, CHANGED, MOVED, MOVED_VELOCITY, KINETIC, POTENTIAL, POWER = range(N_JUDGED)


def assemble(t, tolerance, most, dynamics):
    """Call `to_position_constraints` from Python."""
    m = dynamics_view(dynamics)
    return to_position_constraints(state_view(m.state), m, t, tolerance, most)


def correct_velocities(t, dynamics):
    """Call `to_velocity_constraints` from Python."""
    m = dynamics_view(dynamics)
    return to_velocity_constraints(state_view(m.state), m, t)


def accelerate(t, acceleration, dynamics):
    """Call `to_accelerations` from Python, and copy the accelerations."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    status = to_accelerations(s, m, t)
    for k in range(s.n_u):
        acceleration[k] = factors_view(m.acceleration_factors).b[k]
    return status


def trailing_rates(count, times, q, u, rates, dynamics):
    """Compute the rates of `m.trailing_row` at many consistent states, shape (count, n_trailing); return the number of completed rows."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    values = floats(s.values[ACCELERATION])
    for row in range(count):
        copied(s.q, shifted(q, row * s.n_q), s.n_q)
        copied(s.u, shifted(u, row * s.n_u), s.n_u)
        if to_accelerations(s, m, times[row]) < 0:
            return row
        for k in range(m.n_trailing):
            rates[row * m.n_trailing + k] = values[m.trailing_source[k]]
    return count


def factor_and_solve(b, factors):
    """Overwrite b by the solution of A x = b; return 0, or a negative status if the matrix is singular."""
    equilibrate(factors_view(factors))
    scale(factors_view(factors))
    if factor(factors) != DONE:
        return SINGULAR
    solve(factors_view(factors), b)
    return 0


@compiled
def _largest_violation(s, violation):
    """Return the largest violation of a joint: the norm over its equations (for a revolute joint, the gap)."""
    largest = 0.0
    for joint in range(s.n_joints):
        total = 0.0
        for row in range(s.joint_start[joint], s.joint_start[joint + 1]):
            total += violation[row] * violation[row]
        largest = max(largest, total)
    return sqrt(largest)


@compiled
def _led_astray(s, q, violation):
    """Return True if a projection has moved a coordinate from q by far more than the violation requires."""
    moved = 0.0
    for k in range(s.n_q):
        moved = max(moved, abs(s.q[k] - q[k]))
    return moved > CONSISTENCY.amplified * violation and moved > CONSISTENCY.moved * largest_of(s.q, s.n_q)


@compiled
def _output_point(s, m, t, q, project, tolerance, judged):
    """Project the state if requested; compute accelerations, multipliers and output terms; 0 or a negative status."""
    take_unit_length(s)
    copied(q, s.q, s.n_q)
    if s.n_c > 0:
        joints = state_view(m.constraining)
        violations = evaluate(joints, MOTION, t)
        if project:
            judged[DRIFT] = _largest_violation(s, violations)
            status = to_constraints(s, m, t, tolerance, CONSISTENCY.most_moves)
            if status < 0:
                return status
            if _led_astray(s, q, judged[DRIFT]):
                return SINGULAR
            if status == 0:
                evaluate(joints, MOTION, t)
        judged[GAP] = _largest_violation(s, violations)
        judged[GAP_RATE] = _largest_violation(s, shifted(violations, s.n_c))
    status = consistent_accelerations(s, m, t)
    if status < 0:
        return status
    copied(s.a, factors_view(m.acceleration_factors).b, s.n_u)
    share_turns(s, m.turned_for_output, m.n_turned_for_output)  # the others follow from the accelerations
    call_kernels(s, OUTPUT, t)
    return 0


@compiled
def _judge_moves(s, m, q, u, judged):
    """Store the largest changes of a projection: of a velocity, and of positions and velocities by roots of inertias."""
    moved = 0.0
    for k in range(s.n_q):
        moved = max(moved, abs(s.q[k] - q[k]) * m.root_q[k])
    judged[MOVED] = moved
    changed = 0.0
    moved = 0.0
    for k in range(s.n_u):
        change = abs(s.u[k] - u[k])
        changed = max(changed, change)
        moved = max(moved, change * m.root_u[k])
    judged[CHANGED] = changed
    judged[MOVED_VELOCITY] = moved


@compiled
def _sum_of(values, places, count):
    total = 0.0
    for k in range(count):
        total += values[places[k]]
    return total


@compiled
def _judge_energies(s, m, values, judged):
    """Store kinetic and potential energy, and power."""
    total = 0.0
    for k in range(s.n_u):
        total += m.mass[k] * s.u[k] * s.u[k]
    judged[KINETIC] = 0.5 * total + _sum_of(values, m.kinetic, m.n_kinetic)
    judged[POTENTIAL] = _sum_of(values, m.potential, m.n_potential)
    judged[POWER] = _sum_of(values, m.power, m.n_power)


@compiled
def _store(lines, width, first, n_columns, columns, stride, rows):
    """Store the numbers from `first` on of some lines in columns of a table; return the next number."""
    for k in range(n_columns):
        column = shifted(columns, k * stride)
        if rows == LINES:
            for row in range(LINES):
                column[row] = lines[row * width + first + k]
        else:
            for row in range(rows):
                column[row] = lines[row * width + first + k]
    return first + n_columns


def output_points(
    count, times, q_before, u_before, project, tolerance, stride, q, u, acceleration, lam, output, judged, dynamics
):
    """Compute all reported values at `count` times, row by row; return the number of completed rows.

    If `project` is true, the states before, rows of n_q and n_u numbers, are projected onto the constraints.  The results are
    columns of tables with `stride` rows: q, u, u', lam, output terms, and `JUDGED`.  `status` of the dynamics holds errors.
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    width = s.n_q + 2 * s.n_u + s.n_c + m.n_output + N_JUDGED
    for row in range(count):
        at_q, at_u = shifted(q_before, row * s.n_q), shifted(u_before, row * s.n_u)
        copied(s.q, at_q, s.n_q)
        copied(s.u, at_u, s.n_u)
        line = shifted(m.lines, row % LINES * width)
        of_judged = shifted(line, width - N_JUDGED)
        for k in range(N_JUDGED):
            of_judged[k] = 0.0
        m.status = _output_point(s, m, times[row], line, project, tolerance, of_judged)
        failed = m.status < 0
        if not failed:
            factors, values = factors_view(m.acceleration_factors), floats(s.values[OUTPUT])
            if m.by_elimination:
                of_judged[DETERMINANT] = log_determinant_by_blocks(eliminated_view(m.eliminated))
            else:
                of_judged[DETERMINANT] = log_determinant(factors)
            _judge_moves(s, m, at_q, at_u, of_judged)
            _judge_energies(s, m, values, of_judged)
            copied(line, s.q, s.n_q)
            copied(shifted(line, s.n_q), s.u, s.n_u)
            copied(shifted(line, s.n_q + s.n_u), factors.b, s.n_u)
            copied(shifted(line, s.n_q + 2 * s.n_u), s.lam, s.n_c)
            copied(shifted(line, width - N_JUDGED - m.n_output), values, m.n_output)
        rows = row % LINES if failed else row % LINES + 1
        if failed or rows == LINES or row == count - 1:
            begin = row - row % LINES
            at = _store(m.lines, width, 0, s.n_q, shifted(q, begin), stride, rows)
            at = _store(m.lines, width, at, s.n_u, shifted(u, begin), stride, rows)
            at = _store(m.lines, width, at, s.n_u, shifted(acceleration, begin), stride, rows)
            at = _store(m.lines, width, at, s.n_c, shifted(lam, begin), stride, rows)
            at = _store(m.lines, width, at, m.n_output, shifted(output, begin), stride, rows)
            _store(m.lines, width, at, N_JUDGED, shifted(judged, begin), stride, rows)
        if failed:
            return row
    return count
