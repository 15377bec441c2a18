"""Polished dense output for stiff scenes.

IDA interpolates each unknown separately.  If a step is long compared with the stiffest oscillation, interpolation
errors in positions cause forces far beyond the actual ones.  Newton's iteration
    M delta = F(t, y, y'),  y -= delta,  y' -= cj delta,  M = dF/dy + cj dF/dy'
restores the equilibrium of stiff forces.  Small rotations since IDA's last setup also rotate stiff directions, so this
iteration has its own factors.  They are used with the cj of their matrix as long as they converge, in steps that are
not longer: with the cj of a shorter step, forces of inertia would balance spurious forces.

The equations have other solutions: forces of inertia at high velocities also balance spurious forces.  Large spurious
forces lead the iteration there.  So moves are bounded: by some tolerances, or by the change over the step if that is more.
"""

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, state_view, view_of
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import add_entries, add_products, add_sizes, evaluate, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK
from stiffmbs.dynamics.native.block_systems import to_position_constraints
from stiffmbs.dynamics.native.parameters import CONSISTENCY
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.error_control.native.parameters import NEWTON, POLISHING
from stiffmbs.solve.ida.native.layouts import OUTPUT_CORRECTION

INFINITE = float("inf")

output_correction_view = view_of("OutputCorrection", OUTPUT_CORRECTION)


@compiled
def _placed(b, t):
    """Load the state to be corrected: the prediction of the current step, or the interpolant at a time."""
    if b.predicts:
        call_int(b.predict, (b.memory, b.at_zero, b.at_y))
        return call_int(b.predict_rate, (b.memory, b.at_zero, b.at_yp)) >= OK
    if call_int(b.interpolate, (b.memory, t, int32(0), b.at_y)) < OK:
        return False
    return call_int(b.interpolate, (b.memory, t, int32(1), b.at_yp)) >= OK


@compiled
def _factored(b, s, e, t, cj):
    b.factored = 0.0
    load(s, e, b.y, b.yp)
    add_entries(e, evaluate(s, e.matrix_set, t), cj, floats(b.entries))
    if call_int(b.setup, (b.solver, b.matrix)) != OK:
        return False
    b.factored = cj
    return True


@compiled
def _look(b, s, e, t):
    load(s, e, b.y, b.yp)
    add_products(e, evaluate(s, e.residual_set, t), b.y, b.yp, b.defect)
    add_sizes(e, floats(s.values[e.residual_set]), b.y, b.yp, b.size)


@compiled
def _unbalanced(b, defect):
    """Return the largest relative imbalance of the equations of motion, in units of the allowed one."""
    part = 0.0
    first = 0
    for kind in range(2):
        largest = 0.0
        left = 0.0
        for k in range(first, b.force_end[kind]):
            largest = max(largest, b.size[b.force_row[k]])
            left = max(left, abs(defect[b.force_row[k]]))
        first = b.force_end[kind]
        if left > 0.0:
            part = max(part, left / (b.balanced * largest))
    return part


@compiled
def _by_closing(b, s, e, t):
    """Return the imbalance with joints closed by a projection."""
    copied(b.pose, s.q, s.n_q)
    if (
        to_position_constraints(s, dynamics_view(b.dynamics), t, CONSISTENCY.position_tolerance, CONSISTENCY.most_moves)
        < 0
    ):
        copied(s.q, b.pose, s.n_q)
        return INFINITE
    add_products(e, evaluate(s, e.residual_set, t), b.y, b.yp, b.correction)
    copied(s.q, b.pose, s.n_q)
    return _unbalanced(b, b.correction)


@compiled
def _are_closed(b):
    """Return True if the joints are closed: a projection would move no stiff elements."""
    opening = 0.0
    for k in range(b.n_joint_rows):
        opening = max(opening, abs(b.defect[b.joint_row[k]]))
    return opening <= CONSISTENCY.position_tolerance


@compiled
def _is_balanced(b):
    """Return True if forces balance and joints are closed.

    Where they are not, a correction costs less than the projection of `_left`, as its factors serve many output times.
    """
    return _are_closed(b) and _unbalanced(b, b.defect) <= 1.0


@compiled
def _left(b, s, e, t):
    """Return the largest relative imbalance of the equations of motion, as interpolated and with joints closed."""
    part = _unbalanced(b, b.defect)
    return part if part > 1.0 or _are_closed(b) else max(part, _by_closing(b, s, e, t))


@compiled
def _in_tolerances(b, e):
    """Return the RMS of the vector of corrections in units of the tolerance."""
    squares = 0.0
    for k in range(e.n):
        part = b.correction[k] * b.weight[k]
        squares += part * part
    return (squares / e.n) ** 0.5


@compiled
def _corrected(b, e, cj):
    """Apply one correction, with y' by y times cj; return its size in units of the tolerance."""
    call_int(b.solve, (b.solver, b.matrix, b.at_correction, b.at_defect, 0.0))
    for k in range(e.n):
        b.y[k] -= b.correction[k]
        b.yp[k] -= cj * b.correction[k]
    return _in_tolerances(b, e)


@compiled
def _is_near(b, e, t):
    """Return True if corrections moved an interpolated state by no more than its error may be, or the change over the step.

    The error test bounds those of a prediction.
    """
    if b.predicts:
        return True
    call_int(b.interpolate, (b.memory, t, int32(1), b.at_correction))
    change = b.step * _in_tolerances(b, e)
    call_int(b.interpolate, (b.memory, t, int32(0), b.at_correction))
    for k in range(e.n):
        b.correction[k] -= b.y[k]
    return _in_tolerances(b, e) <= max(POLISHING.most_moved, change)


@compiled
def _remaining(b, s, e, t, once):
    """Correct once, or until the error is negligible by the convergence rate, or forces balance.

    Return 0 if it is, or they do, otherwise the last correction.
    """
    rate = 1.0
    before = 0.0
    size = 0.0
    for k in range(1 if once else POLISHING.most_corrections):
        size = _corrected(b, e, b.factored)
        if k > 0:
            rate = size / before
        if (size if k > 0 and not rate < POLISHING.slowest else rate * size) <= b.enough:
            return 0.0
        before = size
        _look(b, s, e, t)
        if _is_balanced(b):
            return 0.0
        if k > 0 and not rate < POLISHING.slowest:
            break
    return size


@compiled
def _corrected_by(b, s, e, t, parts, least):
    """Correct the state by matrices of steps shorter by factors from `parts` to `least`; return False on failure."""
    while parts >= least:
        if not _factored(b, s, e, t, parts * b.current):
            return False
        _corrected(b, e, b.current)
        _look(b, s, e, t)
        parts /= CONSISTENCY.step_parts
    return True


@compiled
def _by_new_factors(b, s, e, t, parts):
    """Correct the state by new factors while corrections become smaller; return True if they converge."""
    before = INFINITE
    size = INFINITE
    for _ in range(POLISHING.most_corrections):
        if not (_corrected_by(b, s, e, t, parts, CONSISTENCY.step_parts) and _factored(b, s, e, t, b.current)):
            return False
        size = _remaining(b, s, e, t, parts > 1.0)
        if not 0.0 < size < before:
            break
        before = size
    if size == 0.0:
        return True
    left = _left(b, s, e, t)
    return left <= 1.0 or (size <= NEWTON.loosest and b.balanced * left <= POLISHING.rounded_off)


@compiled
def _converged(b, s, e, t):
    """Correct the state by new factors; return False if it does not converge, or to another solution.

    The geometric stiffness of spurious forces may exceed inertia. Matrices of shorter steps remove these forces first.
    """
    parts = 1.0
    for _ in range(POLISHING.most_corrections):
        if _by_new_factors(b, s, e, t, parts) and _is_near(b, e, t):
            return True
        parts *= CONSISTENCY.step_parts
        if not _placed(b, t):
            break
        _look(b, s, e, t)
    b.factored = 0.0  # the factors of a short step make any correction small
    return False


@compiled
def _without_spurious_forces(b, s, e, t):
    """Interpolate, and remove spurious forces; return True if that improves the balance.

    Forces may jump at an event, so that no state has a balance. Matrices of shorter steps move stiff directions only.
    """
    if not _placed(b, t):
        return False
    _look(b, s, e, t)
    unbalanced = _left(b, s, e, t)
    corrects = unbalanced > 1.0 and _corrected_by(b, s, e, t, POLISHING.at_events**2, POLISHING.at_events)
    return corrects and _left(b, s, e, t) < unbalanced


@compiled
def count_failure(b, t):
    """Count an output time at which stiff forces do not balance."""
    if b.failed == 0:
        b.first_failed = t
    b.failed = b.failed + 1


@compiled
def corrected(output_correction, state, equations, t, step):
    """Interpolate and correct the state in the table's y and y'; return False if the interpolant is to be used.

    `step`: length of the step that contains the time.
    """
    b = output_correction_view(output_correction)
    b.step = step
    s = state_view(state)
    e = equations_view(equations)
    if not _placed(b, t):
        return False
    _look(b, s, e, t)
    if _is_balanced(b):
        return True
    if call_int(b.weights, (b.memory, b.at_weight)) < OK:
        return False
    if 0.0 < b.factored <= b.current:
        if _remaining(b, s, e, t, False) == 0.0 and _is_near(b, e, t):
            return True
        _placed(b, t)
        _look(b, s, e, t)
    if _converged(b, s, e, t):
        return True
    _placed(b, t)
    _look(b, s, e, t)
    if _left(b, s, e, t) <= 1.0:
        return True
    count_failure(b, t)
    corrects = _without_spurious_forces(b, s, e, t)
    b.factored = 0.0  # the factors of a short step make any correction small
    return corrects


@compiled
def corrected_at_event(output_correction, state, equations, before, y):
    """Remove spurious forces from an interpolated state y at an event, if that improves the balance just before it.

    Forces may jump at the event.  Their balance with those of its far side would move the state as if they had acted before.
    """
    b = output_correction_view(output_correction)
    s = state_view(state)
    e = equations_view(equations)
    if _without_spurious_forces(b, s, e, before):
        for k in range(e.n):
            y[k] += b.y[k]
        call_int(b.interpolate, (b.memory, before, int32(0), b.at_y))
        for k in range(e.n):
            y[k] -= b.y[k]
    b.factored = 0.0  # another step follows


@compiled
def solved(output_correction, state, equations, t, cj, total):
    """Compute the corrections of the current step from its prediction; return False if they do not converge."""
    b = output_correction_view(output_correction)
    s = state_view(state)
    e = equations_view(equations)
    converges = False
    if _predicted(b, t, cj):
        _look(b, s, e, t)
        converges = _converged(b, s, e, t)
    _take_total(b, e, t, total)
    return converges


@compiled
def solved_across_kinks(output_correction, state, equations, t, cj, total, enough):
    """Compute the same by Newton's iteration with a matrix at each iterate, up to a correction of `enough` tolerances.

    A matrix of the other side of a kink may diverge. The equations are linear on each side, up to the change in a step,
    so that the last correction leaves far less than its size.
    """
    b = output_correction_view(output_correction)
    s = state_view(state)
    e = equations_view(equations)
    converges = False
    if _predicted(b, t, cj):
        for _ in range(POLISHING.most_corrections):
            _look(b, s, e, t)
            if not _factored(b, s, e, t, cj):
                break
            if _corrected(b, e, cj) <= enough:
                converges = True
                break
    _take_total(b, e, t, total)
    return converges


@compiled
def _predicted(b, t, cj):
    """Load the prediction of the current step; return True if that and the tolerances are known."""
    b.current = cj
    b.predicts = 1
    return _placed(b, t) and call_int(b.weights, (b.memory, b.at_weight)) >= OK


@compiled
def _take_total(b, e, t, total):
    """Store the corrections from the prediction of the current step."""
    copied(total, b.y, e.n)
    _placed(b, t)
    for k in range(e.n):
        total[k] -= b.y[k]
    b.predicts = 0
