"""Projection onto the constraints that does not change stiff forces, and the changes of forces by a projection."""

from stiffmbs.compile.machine.native.access import compiled, equations_view, factors_view, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import MOTION, add_entries, add_products, evaluate
from stiffmbs.compile.machine.native.factors import DONE, factored, solve
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.compile.machine.native.statuses import NO_CONVERGENCE, SINGULAR
from stiffmbs.dynamics.native.block_systems import ROUNDING, largest_of, largest_open
from stiffmbs.dynamics.native.parameters import CONSISTENCY


@compiled
def _right_side(s, factors, equations, values, before, part):
    """Set the violations and a part of the changes of forces as right side."""
    f = factors_view(factors)
    add_products(equations_view(equations), values, f.previous, f.previous, f.b)
    for k in range(s.n_u):
        f.b[k] = part * (f.b[k] - before[k])


@compiled
def _moved(s, t, factors, equations, before, cj):
    """Move velocities, or positions for a positive cj, as long as that restores forces; return True if joints are closed."""
    last = float("inf")
    closed = False
    for move in range(CONSISTENCY.most_moves):
        values = evaluate(s, MOTION, t)
        _right_side(s, factors, equations, values, before, 1.0 / cj if cj > 0.0 else 1.0)
        closed = largest_open(s, values) <= max(CONSISTENCY.position_tolerance, ROUNDING * largest_of(s.q, s.n_pose))
        f = factors_view(factors)
        solve(f, f.b)
        size = largest_of(f.b, s.n_u)
        if closed and not size < CONSISTENCY.restored * last:
            return True
        if closed and move > 0:
            last = size
        if cj > 0.0:
            add_rates(s, f.b, 1.0, s.q)
            take_unit_length(s)
        else:
            for k in range(s.n_u):
                s.u[k] += f.b[k]
    return closed


def project_stiffly(t, cj, before, positions, velocities, factors, state):
    """Project q and u by moves with the matrix of an implicit step, cj M - f_u - f_q / cj; 0 or a negative status.

    Moves on each level go on while they restore forces. `before`: memory for n_u forces.
    """
    s = state_view(state)
    e = equations_view(positions)
    f = factors_view(factors)
    for k in range(s.n_u):
        before[k] = 0.0
    _right_side(s, factors, positions, evaluate(s, MOTION, t), before, 1.0)
    copied(before, f.b, s.n_u)
    add_entries(e, evaluate(s, e.matrix_set, t), cj, f.a)
    if factored(factors) != DONE:
        return SINGULAR
    moved = _moved(s, t, factors, positions, before, cj) and _moved(s, t, factors, velocities, before, 0.0)
    return 0 if moved else NO_CONVERGENCE


@compiled
def _add_forces(s, t, q, u, n, source, row, factor, target):
    copied(s.q, q, s.n_q)
    copied(s.u, u, s.n_u)
    values = evaluate(s, MOTION, t)
    for k in range(n):
        target[row[k]] += factor * values[source[k]]


def force_changes(count, t, q_before, u_before, q, u, n, source, row, weight, work, changes, state):
    """Compute the largest change of a weighted force between two states at each of `count` times.

    `source`, `row`: the n entries of the forces among the values of the set ``motion``. `work`: n_u numbers.
    """
    s = state_view(state)
    for k in range(count):
        for i in range(s.n_u):
            work[i] = 0.0
        _add_forces(s, t[k], shifted(q_before, k * s.n_q), shifted(u_before, k * s.n_u), n, source, row, -1.0, work)
        _add_forces(s, t[k], shifted(q, k * s.n_q), shifted(u, k * s.n_u), n, source, row, 1.0, work)
        for i in range(s.n_u):
            work[i] *= weight[i]
        changes[k] = largest_of(work, s.n_u)
