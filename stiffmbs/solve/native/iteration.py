"""When Newton's iteration in a step has converged: IDA's test, but for rates that were measured long ago.

What a correction leaves is its size times rate / (1 - rate), with the rate at which corrections shrink.  IDA
measures it where an iteration matrix is new, and the iteration converges quadratically, and takes it for good until
cj changes; so in long stretches of equal steps one correction with an ever older matrix passes, whatever it leaves.
The error estimates become noise, order and steps sink.

Here the rate is foreseen from its two causes. With cj the matrix changes: IDA scales corrections by 2 / (1 + r), r
being cj over that of the matrix, which for an equation u' = lambda u leaves |1 - 2 / (1 + r) (r - z) / (1 - z)| with
z = lambda / cj; where nothing grows, Re z <= 0, that is at most |r - 1| / (r + 1). And bodies turn away from where
the matrix was made: this part is taken to grow with the time since then, as fast as it did when a rate was last
measured, also under earlier matrices. A rate that was measured where the matrix was new does not count. Where forces
follow reactions and the iteration has been given up, the rate of the next matrix is measured: friction bends where a reaction
vanishes, and a matrix for the predicted sign of the reaction leaves another force. A matrix that has become slow, or with
which the iteration cannot get there in the corrections that are left, is made anew.

How far the iteration is taken follows from the stiffness of the scene for long steps (`stiffmbs.solve.error_control.newton`). An
error left in a position makes an acceleration, and that a velocity within the step; so shorter steps bear more, in
proportion to cj.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import address_of, compiled, floats, view_of
from stiffmbs.solve.native.calls import call_address, call_int, int32
from stiffmbs.solve.native.tables.steps import ITERATION

SETTLED, GO_ON, GIVE_UP = 0, 901, 902
"""SUN_SUCCESS, SUN_NLS_CONTINUE and SUN_NLS_CONV_RECVR of sundials_nonlinearsolver.h; after the last, the solver has a matrix that is
not new made anew, and IDA tries a smaller step where it is."""
MADE = -1
"""The age that a matrix is given when it is made; the step's first correction makes it 0."""
LAST = 3
"""Corrections before the last one that IDA allows."""
NOTHING = 1e-8
"""Part of what may be left that is not worth a look at the rate, as IDA has it."""
UNKNOWN = 20.0
"""What is left of a correction at the most, relative to it, as IDA has it after a new matrix."""
DIVERGING = 0.9
"""The rate from which the iteration is given up, as IDA has it."""
SLOWEST = 0.1
"""The rate beyond which a matrix is made anew (0.1 is better than 0.2 and 0.3 in the plane, and as good in space)."""
TRUSTED = 20
"""Steps after which a rate is measured anew (with no end to it a bushing of 1e8 N/m takes a third longer)."""
LEAST = 0.1
"""Part of a measured rate that is put down to the matrix' age at the least."""
LOOSEST, LONG_STEPS = 0.03, 200.0
"""Part of the tolerance that short steps may leave at the most; cj, 1/s, up to which steps are long."""

iteration_view = view_of("Iteration", ITERATION)


@compiled
def _size(c, correction, weights):
    """Root mean square in units of the tolerance."""
    values = floats(call_address(c.array_of, correction))
    weight = floats(call_address(c.array_of, weights))
    squares = 0.0
    for k in range(c.n):
        part = values[k] * weight[k]
        squares += part * part
    return (squares / c.n) ** 0.5


@compiled
def _left(rate, size):
    """What is left after a correction of a size."""
    return min(rate / (1.0 - rate), UNKNOWN) * size if rate < 1.0 else UNKNOWN * size


@compiled
def _predicted(c):
    """The rate, from those measured before; 1 where it has to be measured."""
    c.since += 1
    age = c.age
    if age == 0:
        c.matrix_cj = c.cj
        c.span = 0.0
    c.span += 1.0 / c.cj
    c.by_cj = abs(c.cj - c.matrix_cj) / (c.cj + c.matrix_cj)
    bends = age == 0 and c.by_reactions == 1 and c.given_up == 1
    known = c.growth >= 0.0 and (c.since <= TRUSTED or age == 0) and not bends
    return c.by_cj + c.growth * c.span if known else 1.0


@compiled
def _first(c, size, enough):
    """After the first correction, the rate is what is foreseen."""
    c.age += 1
    age = c.age
    rate = _predicted(c)
    c.first = size
    if size <= NOTHING * enough:
        return SETTLED
    slow = c.slow == 1 and age > 0
    c.slow = 0
    if slow:
        return GIVE_UP
    return SETTLED if _left(rate, size) <= enough else GO_ON


@compiled
def _later(c, size, enough):
    """After further corrections it is the mean of theirs."""
    done = c.done
    age = c.age
    rate = (size / c.first) ** (1.0 / done)
    if not rate <= DIVERGING:
        return GIVE_UP
    if age > 0:
        c.growth = max(rate - c.by_cj, LEAST * rate) / c.span
        c.since = 0
    c.slow = 1 if rate > SLOWEST else 0
    left = _left(rate, size)
    if left <= enough:
        return SETTLED
    return GIVE_UP if age > 0 and left * rate ** (LAST - done) > enough else GO_ON


def converged(solver, total, correction, enough, weights, table):
    """SUNNonlinSolConvTestFn: whether what the iteration leaves is at most `enough`, in units of the tolerance, or what short steps bear."""
    c = iteration_view(table)
    size = _size(c, correction, weights)
    call_int(c.iteration_of, (solver, address_of(c.done)))
    if c.done == 0:
        call_int(c.cj_of, (c.memory, address_of(c.cj)))
    allowed_residual = max(enough, min(LOOSEST, enough * c.cj / LONG_STEPS))
    verdict = _first(c, size, allowed_residual) if c.done == 0 else _later(c, size, allowed_residual)
    if verdict == GIVE_UP:
        c.given_up = 1
    elif verdict == SETTLED and c.age > 0:
        c.given_up = 0
    return int32(verdict)
