"""Linear solver for IDA: sparse LU in a fixed order of pivots, as flat lists without inner loops.

`stiffmbs.compile.machine.native.factors.factor` finds the order by threshold pivoting.  The elimination is stored as a
list of updates, `lu[target] -= lu[left] * lu[right]`, for later factorisations.  They need no search and no short inner
loops, whose ends a processor cannot predict.  A pivot that becomes too small causes a new order.

References
----------
Gilbert and Peierls, Sparse partial pivoting in time proportional to arithmetic operations, SIAM J. Sci. Stat. Comput. 9
(1988) 862-874: the elimination by columns that the list repeats.
"""

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, ints, shifted, view_of
from stiffmbs.compile.machine.native.calls import call_address, int32
from stiffmbs.compile.machine.native.factors import DONE, FULL, equilibrate, factor, scale
from stiffmbs.compile.machine.native.memory import FLOAT, INDEX, MOST_INDICES, holds
from stiffmbs.compile.machine.native.statuses import CONTENT, FAILED, OK, RECOVERABLE
from stiffmbs.solve.linear_solvers.native.layouts import FIXED_ORDER
from stiffmbs.solve.linear_solvers.native.parameters import PIVOTS

LU, ROW, COLUMN, UPDATE = (list(FIXED_ORDER).index(name) for name in ("lu", "row", "column", "update"))

fixed_order_view = view_of("FixedOrder", FIXED_ORDER)


@compiled
def _count_updates(f):
    count = 0
    for j in range(f.n):
        for p in range(f.u_start[j], f.u_start[j + 1] - 1):
            k = f.u_row[p]
            count += f.l_start[k + 1] - f.l_start[k] - 1
    return count


@compiled
def _list_memory(table, f):
    """Provide memory for the factors in `f` and the list of their updates; return False if there is not enough."""
    off_diagonal = f.l_start[f.n] + f.u_start[f.n] - 2 * f.n
    length = 3 * _count_updates(f)
    if off_diagonal + f.n > MOST_INDICES:
        return False
    if not (holds(table, ROW, off_diagonal, INDEX) and holds(table, COLUMN, off_diagonal, INDEX)):
        return False
    return holds(table, LU, off_diagonal + f.n, FLOAT) and holds(table, UPDATE, length, INDEX)


@compiled
def _listed(s, f):
    """List the updates of the elimination for the pivots in `f`."""
    # One array has L without its diagonal, U without its diagonal, and the diagonal.  The backward solution takes the
    # columns of U from the last one on; they are stored in this order, so that it reads memory forwards.
    n = f.n
    n_lower = f.l_start[n] - n
    n_upper = f.u_start[n] - n
    diagonal = n_lower + n_upper
    upper = n_lower + n_upper  # upper entries are stored from the last column to the first
    count = 0
    for k in range(n):
        s.mark[k] = -1
    for j in range(n):
        lower = f.l_start[j] - j
        for p in range(f.l_start[j] + 1, f.l_start[j + 1]):
            s.row[lower], s.column[lower] = f.l_row[p], j
            s.mark[f.l_row[p]] = lower
            lower += 1
        last = f.u_start[j + 1] - 1
        upper -= last - f.u_start[j]
        for p in range(f.u_start[j], last):
            at = upper + p - f.u_start[j]
            s.row[at], s.column[at] = f.u_row[p], j
            s.mark[f.u_row[p]] = at
        s.mark[j] = diagonal + j
        s.update_start[j] = count
        for p in range(f.u_start[j], last):  # rows of U in topological order, as `factor` found them
            k = f.u_row[p]
            left = f.l_start[k] - k
            for below in range(f.l_start[k] + 1, f.l_start[k + 1]):
                s.update[3 * count] = s.mark[f.l_row[below]]
                s.update[3 * count + 1] = left
                s.update[3 * count + 2] = s.mark[k]
                left += 1
                count += 1
        column = f.order[j]
        for p in range(f.a_start[column], f.a_start[column + 1]):
            s.slot[p] = s.mark[f.pivot[f.a_row[p]]]
            s.weight[p] = f.scale[f.a_row[p]] * f.scale[column]
    s.update_start[n] = count
    s.n_lower = n_lower
    s.n_upper = n_upper


@compiled
def _eliminated(s, f):
    """Factor the matrix in `f` by the list; return False if a pivot is too small."""
    n = f.n
    lu = s.lu
    update = s.update
    n_lower = s.n_lower
    diagonal = n_lower + s.n_upper
    for p in range(diagonal + n):
        lu[p] = 0.0
    for p in range(f.a_start[n]):
        lu[s.slot[p]] += s.weight[p] * f.a[p]
    largest = 0.0  # multiplier: rows cannot be exchanged, so its size bounds the growth of rounding errors
    for j in range(n):
        for m in range(3 * s.update_start[j], 3 * s.update_start[j + 1], 3):
            lu[update[m]] -= lu[update[m + 1]] * lu[update[m + 2]]
        inverse = 1.0 / lu[diagonal + j]
        lu[diagonal + j] = inverse
        for p in range(f.l_start[j] - j, f.l_start[j + 1] - j - 1):
            lu[p] *= inverse
            largest = max(largest, abs(lu[p]))
        if not (largest < PIVOTS.largest and abs(inverse) < float("inf")):  # also false for NaN
            return False
    # A = L D U with unit triangles: a solution multiplies by the inverse pivots once, between both triangles.
    for p in range(n_lower, diagonal):
        lu[p] *= lu[diagonal + s.row[p]]
    return True


@compiled
def refactored(factors, kept):
    """Search for pivots of the matrix in the table of factors, which is temporarily scaled; return the outcome."""
    f = factors_view(factors)
    for p in range(f.a_start[f.n]):
        kept[p] = f.a[p]
    equilibrate(f)
    scale(f)
    outcome = factor(factors)
    for p in range(f.a_start[f.n]):
        f.a[p] = kept[p]
    return outcome


def setup(solver, matrix):
    """Set up the linear solver (SUNLinSolSetup): factors in the known order, or in a new one."""
    table = ints(solver[CONTENT])
    known = fixed_order_view(table)
    if known.ready and _eliminated(known, factors_view(known.factors)):
        return int32(OK)
    known.ready = 0
    outcome = refactored(known.factors, known.weight)
    if outcome == DONE and not _list_memory(table, factors_view(known.factors)):
        outcome = FULL
    known.last_flag = outcome  # returned by SUNLinSolLastFlag
    if outcome != DONE:
        return int32(FAILED if outcome == FULL else RECOVERABLE)
    s = fixed_order_view(table)  # the memory may have grown
    f = factors_view(s.factors)
    _listed(s, f)
    s.ready = 1
    return int32(OK if _eliminated(s, f) else RECOVERABLE)


def solve(solver, matrix, x, b, tolerance):
    """Solve A x = b (SUNLinSolSolve)."""
    s = fixed_order_view(ints(solver[CONTENT]))
    f = factors_view(s.factors)
    into, of = floats(call_address(s.array_of, x)), floats(call_address(s.array_of, b))
    n = f.n
    lu = s.lu
    y = s.x
    n_lower = s.n_lower
    diagonal = n_lower + s.n_upper
    for k in range(n):
        y[f.pivot[k]] = f.scale[k] * of[k]
    for p in range(n_lower):
        y[s.row[p]] -= lu[p] * y[s.column[p]]
    inverse = shifted(lu, diagonal)
    for k in range(n):
        y[k] *= inverse[k]
    for p in range(n_lower, diagonal):
        y[s.row[p]] -= lu[p] * y[s.column[p]]
    for k in range(n):
        into[f.order[k]] = f.scale[f.order[k]] * y[k]
    return int32(OK)
