"""Dynamics of a state for Python: assembly, projections, accelerations and output rows."""

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import MOTION, OUTPUT, POSITION, call_kernels, evaluate, share_turns
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
from stiffmbs.dynamics.native.consistent import consistent_accelerations, from_row_to_row
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import dynamics_view, eliminated_view


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


def factor_and_solve(b, factors):
    """Overwrite b by the solution of A x = b; return 0, or a negative status if the matrix is singular."""
    equilibrate(factors_view(factors))
    scale(factors_view(factors))
    if factor(factors) != DONE:
        return SINGULAR
    solve(factors_view(factors), b)
    return 0


def contradicting(count, begin, end, apart, q, u, mass, rtol, atol, part, tolerances, rate, found, dynamics):
    """Mark the steps among `count` whose midpoint accelerations contradict their polynomial; return their number.

    Each step has two states (n_q, n_u numbers), at a distance of `apart` step lengths before and after its midpoint.
    `rate` is working memory.  A step without a solution for accelerations is marked, too.
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
        if not solved or _contradicts(h, acceleration, rate, s.u, mass, rtol, atol, part, tolerances, s.n_u):
            found[step] = 1
            total += 1
    return total


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
def _output_point(s, m, t, q, project, tolerance, largest, first):
    """Project the state if requested; compute accelerations, multipliers and output terms; 0 or a negative status."""
    for k in range(3):
        largest[k] = 0.0
    take_unit_length(s)
    for k in range(s.n_q):
        q[k] = s.q[k]
    joints = state_view(m.constraining)
    status = 0
    if project and s.n_c > 0:
        largest[2] = _largest_violation(s, evaluate(s, POSITION, t))
        status = from_row_to_row(s, m, t, tolerance, CONSISTENCY.most_moves, first)
        if status < 0:
            return status
        if _led_astray(s, q, largest[2]):
            return SINGULAR
    if s.n_c > 0:
        values = floats(s.values[MOTION]) if status == 1 else evaluate(joints, MOTION, t)
        largest[0] = _largest_violation(s, values)
        largest[1] = _largest_violation(s, shifted(values, s.n_c))
    status = consistent_accelerations(s, m, t)
    if status < 0:
        return status
    copied(s.a, factors_view(m.acceleration_factors).b, s.n_u)
    share_turns(s, m.turned_for_output, m.n_turned_for_output)  # the others follow from the accelerations
    call_kernels(s, OUTPUT, t)
    return 0


def output_points(count, times, project, tolerance, n_output, q, u, acceleration, lam, output, judged, dynamics):
    """Compute all reported values at `count` times, row by row; return the number of completed rows.

    If `project` is true, q and u (rows of n_q, n_u) are projected onto the constraints.  The output is u', lam, the
    output terms, and four numbers per row in `judged`: violations of positions and of velocities (largest of a joint),
    of positions before the projection, and log |det| of the block matrix.  `status` of the dynamics holds errors.
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    for row in range(count):
        at_row = shifted(q, row * s.n_q)
        for k in range(s.n_q):
            s.q[k] = at_row[k]
        for k in range(s.n_u):
            s.u[k] = u[row * s.n_u + k]
        m.status = _output_point(s, m, times[row], at_row, project, tolerance, shifted(judged, 4 * row), row == 0)
        if m.status < 0:
            return row
        factors = factors_view(m.acceleration_factors)
        if m.by_elimination:
            judged[4 * row + 3] = log_determinant_by_blocks(eliminated_view(m.eliminated))
        else:
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


def energies(
    count, n_u, u, mass, n_values, values, n_potential, potential_at, n_power, power_at, n_kinetic, kinetic_at, kinetic,
    potential, power,
):  # fmt: skip
    """Compute kinetic and potential energy and power in `count` rows of velocities and output terms."""
    for row in range(count):
        velocity = shifted(u, row * n_u)
        term = shifted(values, row * n_values)
        total = 0.0
        for k in range(n_u):
            total += mass[k] * velocity[k] * velocity[k]
        kinetic[row] = 0.5 * total
        for k in range(n_kinetic):
            kinetic[row] += term[kinetic_at[k]]
        total = 0.0
        for k in range(n_potential):
            total += term[potential_at[k]]
        potential[row] = total
        total = 0.0
        for k in range(n_power):
            total += term[power_at[k]]
        power[row] = total


@compiled
def _contradicts(h, acceleration, rate, u, mass, rtol, atol, part, tolerances, n_u):
    """Return True if accelerations contradict the rates of a step of length h.

    They must differ by more than a fraction `part` and, over the step, by more than `tolerances` of a velocity.
    """
    off = 0.0
    by_forces = 0.0
    by_rates = 0.0
    most = 0.0
    for k in range(n_u):
        differs = acceleration[k] - rate[k]
        off += mass[k] * differs * differs
        by_forces += mass[k] * acceleration[k] * acceleration[k]
        by_rates += mass[k] * rate[k] * rate[k]
        most = max(most, abs(differs) * h / (atol[k] + rtol * abs(u[k])))
    return not (off <= part * part * max(by_forces, by_rates) or most <= tolerances)
