"""Convergence test of Newton's iteration in a step: IDA's test with an estimated convergence rate.

The error after a correction is its size times rate / (1 - rate).  IDA measures the rate while the iteration matrix is
new and the iteration converges quadratically, and keeps it until cj changes.  In long sequences of equal steps, one
correction with an ever older matrix then always passes.  The error estimates become noise; order and steps decrease.

Here the rate is predicted from its two causes.  First, the matrix changes with cj: IDA scales corrections by
2 / (1 + r), with the ratio r of cj to that of the matrix.  For u' = lambda u and z = lambda / cj, this leaves
    |1 - 2 / (1 + r) (r - z) / (1 - z)| <= |r - 1| / (r + 1)    for Re z <= 0.
Second, bodies rotate away from the pose of the matrix.  This part is assumed to grow with the time since then, at the
last measured rate, also under earlier matrices.  Rates measured with a new matrix do not count.  If forces
may have kinks, the rate is measured after a failed iteration, and the matrices of the iterates are tried.  A
matrix with a slow or insufficient convergence is replaced.

For long steps, the tolerance follows from the stiffness of the scene (`stiffmbs.solve.error_control.newton`).  A
position error causes a velocity error within the step, so shorter steps may leave more, in proportion to cj.
"""

from typing import Final

from stiffmbs.compile.machine.native.access import address_of, compiled, floats, view_of
from stiffmbs.compile.machine.native.calls import call_address, call_int, int32
from stiffmbs.solve.error_control.native.parameters import NEWTON
from stiffmbs.solve.ida.native.layouts import ITERATION
from stiffmbs.solve.ida.native.output_correction import output_correction_view, solved, solved_across_kinks

SETTLED: Final = 0
GO_ON: Final = 901
GIVE_UP: Final = 902
"""SUN_SUCCESS, SUN_NLS_CONTINUE and SUN_NLS_CONV_RECVR of sundials_nonlinearsolver.h.  After the last, the solver
replaces an old matrix, or IDA tries a smaller step."""
MADE: Final = -1
"""Age of a new matrix; the first correction of the step makes it 0."""

iteration_view = view_of("Iteration", ITERATION)


@compiled
def _size(c, correction, weights):
    """Return the RMS of a correction in units of the tolerance."""
    values = floats(call_address(c.array_of, correction))
    weight = floats(call_address(c.array_of, weights))
    squares = 0.0
    for k in range(c.n):
        part = values[k] * weight[k]
        squares += part * part
    return (squares / c.n) ** 0.5


@compiled
def _left(rate, size):
    return min(rate / (1.0 - rate), NEWTON.unknown) * size if rate < 1.0 else NEWTON.unknown * size


@compiled
def _predicted(c):
    """Return the rate predicted from earlier ones; 1 if it has to be measured."""
    c.since += 1
    age = c.age
    if age == 0:
        c.matrix_cj = c.cj
        c.span = 0.0
    c.span += 1.0 / c.cj
    c.by_cj = abs(c.cj - c.matrix_cj) / (c.cj + c.matrix_cj)
    bends = age == 0 and c.has_kinks == 1 and c.given_up == 1
    known = c.growth >= 0.0 and (c.since <= NEWTON.trusted or age == 0) and not bends
    return c.by_cj + c.growth * c.span if known else 1.0


@compiled
def _first(c, size, enough):
    """Test the first correction with the predicted rate."""
    c.age += 1
    age = c.age
    rate = _predicted(c)
    c.first = size
    slow = c.slow == 1 and age > 0
    c.slow = 0
    if slow:
        return GIVE_UP
    return SETTLED if _left(rate, size) <= enough else GO_ON


@compiled
def _later(c, size, enough):
    """Test a further correction with the mean rate of all of them."""
    done = c.done
    age = c.age
    rate = (size / c.first) ** (1.0 / done)
    if not rate <= NEWTON.diverging:
        return GIVE_UP
    if age > 0:
        c.growth = max(rate - c.by_cj, NEWTON.least * rate) / c.span
        c.since = 0
    c.slow = 1 if rate > NEWTON.slowest else 0
    left = _left(rate, size)
    if left <= enough:
        return SETTLED
    hopeless = age > 0 and left * rate ** (NEWTON.last - done) > enough
    return GIVE_UP if hopeless or done >= NEWTON.last else GO_ON


@compiled
def _solved_otherwise(c, total, enough):
    """Return True if other matrices solve the equations: of the iterates, beyond a kink, or of shorter steps in a long one."""
    b = output_correction_view(c.output_correction)
    if c.age > 0 or b.interpolate == 0 or not (c.has_kinks or b.long * c.cj < 1.0):
        return False
    call_int(c.time_of, (c.memory, address_of(c.t)))
    corrections = floats(call_address(c.array_of, total))
    if c.has_kinks and solved_across_kinks(c.output_correction, c.state, c.equations, c.t, c.cj, corrections, enough):
        return True
    return b.long * c.cj < 1.0 and solved(c.output_correction, c.state, c.equations, c.t, c.cj, corrections)


def converged(solver, total, correction, enough, weights, table):
    """Test convergence up to `enough` tolerances, or more for short steps (SUNNonlinSolConvTestFn)."""
    c = iteration_view(table)
    size = _size(c, correction, weights)
    call_int(c.iteration_of, (solver, address_of(c.done)))
    if c.done == 0:
        call_int(c.cj_of, (c.memory, address_of(c.cj)))
    allowed_residual = max(enough, min(NEWTON.loosest, enough * c.cj / NEWTON.long_steps))
    verdict = _first(c, size, allowed_residual) if c.done == 0 else _later(c, size, allowed_residual)
    if verdict == GIVE_UP and _solved_otherwise(c, total, allowed_residual):
        verdict = SETTLED
        c.slow = 1
    if verdict == GIVE_UP:
        c.given_up = 1
    elif verdict == SETTLED and c.age > 0:
        c.given_up = 0
    return int32(verdict)
