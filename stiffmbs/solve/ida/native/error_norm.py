"""Norm of IDA's error test: filtered for strong damping, shared among periods of a law, failing for steps over an event.

A light body in a strong damper follows M u' = f(q) - c u, so u = f(q) / c after a time M / c.  Differences of u, which
estimate the error, then do not represent the error in u, which follows that in q.  After a change of step or order, u
jumps in proportion to the error in q over the step.  IDA then fails every second step and stays at order 1.  Therefore
a step of implicit Euler filters the estimate d,
    (dF/dy + cj dF/dy') e = cj dF/dy' d,
with the current iteration matrix and its factors.  For y' = f this is (I - f_y / cj)^-1 d: it damps errors in
directions with fast decay, except for their effect on other unknowns, and leaves those in slow directions.

After a failure, such a run may pass the next step so easily that IDA doubles the step and fails again.  IDA raises
the order only after equal steps, so the order would stay at 1.  Therefore steps may not grow before these equal steps.

References
----------
L. F. Shampine, L. S. Baca, Error estimators for stiff differential equations, J. Comput. Appl. Math. 11 (1984) 197-207.
E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, Springer 1996, ch. IV.8, eq. (8.19).
"""

from typing import Final

from stiffmbs.compile.machine.native.access import (
    address_of,
    compiled,
    equations_view,
    floats,
    ints,
    state_view,
    view_of,
)
from stiffmbs.compile.machine.native.calls import call_address, call_float, call_int
from stiffmbs.compile.machine.native.statuses import NORM_TABLE, OK, OPERATIONS
from stiffmbs.solve.error_control.native.parameters import A_STABLE_ORDER, EQUAL_STEPS, FILTER
from stiffmbs.solve.ida.native.ida_memory import native_ida_view
from stiffmbs.solve.ida.native.iteration import iteration_view
from stiffmbs.solve.ida.native.layouts import ERROR_NORM

FAILS: Final = 1e10
"""Norm that fails the error test of any order; the same factor enlarges the norms of lower orders, which are compared."""

MOST_REPEATED: Final = 2
"""Number of such failures in a step; after a third one, IDA continues at order 1, and after ten it gives up."""

error_norm_view = view_of("ErrorNorm", ERROR_NORM)


@compiled
def _filtered(c, estimate):
    """Multiply an estimate by (dF/dy + cj dF/dy')^-1 cj dF/dy', with cj of the matrix; return False on failure."""
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
    """Count failures and the steps since then."""
    c.looked = iteration_view(c.iteration).cj
    call_int(c.steps_of, (c.memory, address_of(c.steps)))
    call_int(c.failures_of, (c.memory, address_of(c.failures)))
    steps, failures = c.steps - c.known_steps, c.failures - c.known_failures
    if steps == 0 and failures == 0:
        return
    c.known_steps += steps
    c.known_failures += failures
    if steps < 0:  # each start resets the counters
        c.trouble = 0.0
        c.until = 0
    call_int(c.order_of, (c.memory, address_of(c.order)))
    fades = FILTER.fades_low if c.order <= A_STABLE_ORDER else FILTER.fades
    for _ in range(steps):
        c.trouble *= fades
    c.trouble += max(failures, 0)
    if c.trouble > FILTER.troubled:
        c.until = c.steps + FILTER.lasts
        if failures > 0 and c.order == 1:
            c.equal_until = c.steps + EQUAL_STEPS
            call_int(c.set_growth, (c.memory, 1.0, float("inf")))


@compiled
def _let_grow(c):
    call_int(c.steps_of, (c.memory, address_of(c.steps)))
    if c.steps >= c.equal_until:
        c.equal_until = 0
        call_int(c.set_growth, (c.memory, 1.0, c.growth))


@compiled
def _repeat_up_to(c, part):
    """Make IDA reduce the step to this part after a failure of the error test; to its own choice if `part` is 1."""
    call_int(c.set_largest_part, (c.memory, part))
    call_int(c.set_least_part, (c.memory, part))


@compiled
def _see_event(c, estimate, weights):
    """Make the error test fail if the attempted step has to be repeated up to an event."""
    call_int(c.time_of, (c.memory, address_of(c.t)))
    if c.t == c.attempted:
        return
    c.attempted = c.t
    begun = native_ida_view(ints(c.ida)).internal
    if begun != c.begun:
        c.begun = begun
        c.repeated = 0
    again = c.enlarged != 1.0
    part = call_float(c.part_before_event, (estimate, weights, c.ida)) if c.repeated < MOST_REPEATED else 1.0
    if part < 1.0 or again:
        _repeat_up_to(c, part)
    c.enlarged = 1.0
    if part < 1.0:
        c.enlarged = FAILS / call_float(c.norm, (estimate, weights))
        c.repeated += 1
        c.known_failures += 1


@compiled
def _norm(c, estimate, weights):
    """Return the WRMS norm (N_VWrmsNorm) of an estimate, filtered if the error test fails often."""
    cj = iteration_view(c.iteration).cj
    if cj != c.looked:  # cj changes with every failure
        _look(c)
    if c.equal_until > 0:
        _let_grow(c)
    wanted = c.always or c.steps < c.until
    if wanted and cj < float("inf") and _filtered(c, estimate):
        size = call_float(c.norm, (c.at_filtered, weights))
        if size < FILTER.no_estimate:
            return size
    return call_float(c.norm, (estimate, weights))


def error_norm(estimate, weights):
    """Return the norm of an estimate for IDA's error test and its choice of order and step."""
    c = error_norm_view(ints(ints(estimate[OPERATIONS])[NORM_TABLE]))
    if not c.part_before_event:
        return c.repeats * _norm(c, estimate, weights)
    _see_event(c, estimate, weights)
    return c.repeats * c.enlarged * _norm(c, estimate, weights)
