"""The norm of IDA's error estimates, with errors that strong damping takes away within the step left out.

A light body in a strong damper has no velocity of its own: M u' = f(q) - c u leaves u = f(q) / c after a time M / c.
Differences of u, from which the error is estimated, then show neither the error in u, which follows that in q, nor
where a step or an order is changed: u jumps as the error in q does, over the step.  IDA fails every second step,
and stays at order 1.  So the estimate d is multiplied by what a step of implicit Euler does with it,
    (dF/dy + cj dF/dy') e = cj dF/dy' d,
with the iteration matrix and the factors that Newton's iteration has.  For y' = f this is (I - f_y / cj)^-1 d: errors in
directions with fast decay are damped, and what they do to other unknowns counts; slow directions keep theirs.

A run that creeps has one more trap.  After a failure a step passes so easily that IDA doubles the next one, which fails
again.  IDA raises the order after equal steps alone, so such a run stays at order 1 for good.  So steps may not grow again
before these equal steps have been taken.

References
----------
L. F. Shampine, L. S. Baca, Error estimators for stiff differential equations, J. Comput. Appl. Math. 11 (1984) 197-207.
E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, Springer 1996, ch. IV.8, eq. (8.19).
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import (
    address_of,
    compiled,
    equations_view,
    floats,
    ints,
    state_view,
    view_of,
)
from stiffmbs.solve.native.calls import call_address, call_float, call_int
from stiffmbs.solve.native.iteration import iteration_view
from stiffmbs.solve.native.statuses import NORM_TABLE, OK, OPERATIONS
from stiffmbs.solve.native.tables.steps import ERROR_NORM

FADES_LOW, FADES, LOW = 0.99, 0.8, 2
"""What a step leaves of the count of failures, at orders up to the lowest two and above: at these a run creeps."""
TROUBLED, LASTS = 7.0, 1000
"""Count of failures from which estimates are filtered, and for how many steps.  A run that creeps fails in each step, or in one of seven, which
counts up to 100 or 15; Andrews' mechanism, where the filter only costs, counts up to 6."""
BEFORE_A_RISE, NEVER = 3, 1e9
"""Equal steps at order 1 after which IDA may raise it; growth of a step that no estimate allows."""
NO_ESTIMATE = 1e12
"""Filtered norm beyond which a vector is none of IDA's estimates: IDA measures the solution too, to see what rounding takes of it."""

error_norm_view = view_of("ErrorNorm", ERROR_NORM)


@compiled
def _filtered(c, estimate):
    """Multiply an estimate by (dF/dy + cj dF/dy')^-1 cj dF/dy', with cj of the matrix; False where that fails."""
    e = equations_view(c.equations)
    s = state_view(c.state)
    values = floats(s.values[e.residual_set])
    d = floats(call_address(c.array_of, estimate))
    cj = iteration_view(c.iteration).matrix_cj
    for k in range(e.n):
        c.change[k] = 0.0
    for k in range(e.n_with_y, e.n_with_yp):
        c.change[e.r_row[k]] += cj * e.r_factor[k] * values[e.r_source[k]] * d[e.r_operand[k]]
    return call_int(c.solve, (c.solver, c.matrix, c.at_filtered, c.at_change, 0.0)) == OK


@compiled
def _look(c):
    """Count failures, and steps since then."""
    c.looked = iteration_view(c.iteration).cj
    call_int(c.steps_of, (c.memory, address_of(c.steps)))
    call_int(c.failures_of, (c.memory, address_of(c.failures)))
    steps, failures = c.steps - c.known_steps, c.failures - c.known_failures
    if steps == 0 and failures == 0:
        return
    c.known_steps += steps
    c.known_failures += failures
    if steps < 0:  # counters begin anew with each start
        c.trouble = 0.0
        c.until = 0
    call_int(c.order_of, (c.memory, address_of(c.order)))
    fades = FADES_LOW if c.order <= LOW else FADES
    for _ in range(steps):
        c.trouble *= fades
    c.trouble += max(failures, 0)
    if c.trouble > TROUBLED:
        c.until = c.steps + LASTS
        if failures > 0 and c.order == 1:
            c.equal_until = c.steps + BEFORE_A_RISE
            call_int(c.set_growth, (c.memory, 1.0, NEVER))


@compiled
def _let_grow(c):
    """Let steps grow again where enough equal ones have been taken."""
    call_int(c.steps_of, (c.memory, address_of(c.steps)))
    if c.steps >= c.equal_until:
        c.equal_until = 0
        call_int(c.set_growth, (c.memory, 1.0, c.growth))


def error_norm(estimate, weights):
    """N_VWrmsNorm: the weighted root mean square of an estimate, filtered where the error test fails often."""
    c = error_norm_view(ints(ints(estimate[OPERATIONS])[NORM_TABLE]))
    cj = iteration_view(c.iteration).cj
    if cj != c.looked:  # as it does with every failure
        _look(c)
    if c.equal_until > 0:
        _let_grow(c)
    wanted = c.always or c.steps < c.until
    if wanted and cj < float("inf") and _filtered(c, estimate):
        size = call_float(c.norm, (c.at_filtered, weights))
        if size < NO_ESTIMATE:
            return c.repeats * size
    return c.repeats * call_float(c.norm, (estimate, weights))
