"""When Newton's iteration in a step has converged: IDA's test, but for rates that were measured long ago.

What the last correction leaves is its size times rate / (1 - rate), with the rate at which corrections shrink.  IDA
measures it where an iteration matrix is new, and the iteration converges quadratically, and takes it for good until
cj changes; so in long stretches of equal steps one correction with an ever older matrix passes, whatever it leaves.
The error estimates become noise, order and steps sink.  Here a new matrix' rate is not believed in the next step, and one measured
later grows with the matrix' age, as the distance from where it was made does.  A matrix that has become slow, or with
which the iteration cannot get there in the corrections that are left, is made anew.
"""

from __future__ import annotations

from stiffmbs.compile.layout import ITERATION
from stiffmbs.compile.native.access import compiled, floats, shifted, view_of
from stiffmbs.solve.native.calls import call_address, call_int, int32

SETTLED, GO_ON, GIVE_UP = 0, 901, 902
"""SUN_SUCCESS, SUN_NLS_CONTINUE and SUN_NLS_CONV_RECVR of sundials_nonlinearsolver.h; after the last, the solver has a matrix that is
not new made anew, and IDA tries a smaller step where it is."""
CJ, AT_CJ, FIRST, RATE = range(4)
"""Marks: cj, that for which the rate was measured, size of the first correction, rate."""
DONE, AGE, MEASURED, SLOW = range(4)
"""Counts: corrections before this one, steps since the matrix was made, that number when the rate was measured (0: it was
not), whether the matrix is to be made anew."""
MADE = -1
"""The age that a matrix is given when it is made; the step's first correction makes it 0."""
LAST = 3
"""Corrections before the last one that IDA allows."""
NOTHING = 1e-8
"""Part of what may be left that is not worth a look at the rate, as IDA has it."""
UNKNOWN = 20.0
"""What is left of a correction at the most, in parts of it, as IDA has it after a new matrix."""
DIVERGING = 0.9
"""The rate from which the iteration is given up, as IDA has it."""
SLOWEST = 0.1
"""The rate beyond which a matrix is made anew (0.1 is better than 0.2 and 0.3 in the plane, and as good in space)."""

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
def _first(c, size, enough):
    """After the first correction, the rate is what is foreseen from an earlier one at the same cj."""
    c.count[AGE] += 1
    age = c.count[AGE]
    call_int(c.cj_of, (c.memory, shifted(c.mark, CJ)))
    if age == 0 or c.mark[CJ] != c.mark[AT_CJ]:
        c.count[MEASURED] = 0
    c.mark[FIRST] = size
    if size <= NOTHING * enough:
        return SETTLED
    slow = c.count[SLOW] == 1 and age > 0
    c.count[SLOW] = 0
    if slow:
        return GIVE_UP
    rate = c.mark[RATE] * age / c.count[MEASURED] if c.count[MEASURED] > 0 else 1.0
    return SETTLED if _left(rate, size) <= enough else GO_ON


@compiled
def _later(c, size, enough):
    """After further corrections it is the mean of theirs."""
    done = c.count[DONE]
    age = c.count[AGE]
    rate = (size / c.mark[FIRST]) ** (1.0 / done)
    if not rate <= DIVERGING:
        return GIVE_UP
    c.mark[RATE] = rate
    c.mark[AT_CJ] = c.mark[CJ]
    c.count[MEASURED] = age
    c.count[SLOW] = 1 if rate > SLOWEST else 0
    left = _left(rate, size)
    if left <= enough:
        return SETTLED
    return GIVE_UP if age > 0 and left * rate ** (LAST - done) > enough else GO_ON


def converged(solver, total, correction, enough, weights, table):
    """SUNNonlinSolConvTestFn: whether what the iteration leaves is at most `enough`, in units of the tolerance."""
    c = iteration_view(table)
    size = _size(c, correction, weights)
    call_int(c.iteration_of, (solver, shifted(c.count, DONE)))
    return int32(_first(c, size, enough) if c.count[DONE] == 0 else _later(c, size, enough))
