"""Linear solver for IDA: sparse LU in a fixed order of pivots with two-column supernodes.

Adjacent columns have most rows in common if many unknowns of bodies are coupled, as in spatial models.  An item is a
row with its entries in both columns, with zeros for missing ones.  All earlier supernodes update a column by
`x[row] -= lu[item] * x[k] + lu[item + 1] * x[k + 1]`, with half the index accesses of single entries.  Columns of up to
about ten rows are factored faster by `stiffmbs.solve.linear_solvers.native.fixed_order`.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, ints, shifted, view_of
from stiffmbs.compile.machine.native.calls import call_address, int32
from stiffmbs.compile.machine.native.factors import DONE, FULL
from stiffmbs.compile.machine.native.memory import FLOAT, INDEX, MOST_INDICES, holds
from stiffmbs.compile.machine.native.statuses import CONTENT, FAILED, OK, RECOVERABLE
from stiffmbs.solve.linear_solvers.native.fixed_order import factored_anew
from stiffmbs.solve.linear_solvers.native.layouts import PAIRED_COLUMNS
from stiffmbs.solve.linear_solvers.native.parameters import PIVOTS

LU, ROW, COLUMN, PLACE, UPDATE = (
    list(PAIRED_COLUMNS).index(name) for name in ("lu", "row", "column", "place", "update")
)
FIRST, SECOND = range(2)
"""Position of a column in its items; a single column is the first."""

paired_view = view_of("PairedColumns", PAIRED_COLUMNS)


@compiled
def _sorted(f):
    """Sort the rows above each pivot in the order of their pivots, as required for elimination."""
    for j in range(f.n):
        for p in range(f.u_start[j] + 1, f.u_start[j + 1] - 1):
            row = f.u_row[p]
            at = p
            while at > f.u_start[j] and f.u_row[at - 1] > row:
                f.u_row[at] = f.u_row[at - 1]
                at -= 1
            f.u_row[at] = row


@compiled
def _numbered(s, rows, begin, end, column, item):
    """Create items for the rows of a column that have none; return the number of the next item."""
    for p in range(begin, end):
        row = rows[p]
        if s.mark[row] < 0:
            s.mark[row] = item
            s.row[item], s.column[item] = row, column
            item += 1
    return item


@compiled
def _items(s, rows, begin, end, next_begin, next_end, column, between, item):
    """Create the items of one or two columns; return the number of the next item, or -1 if few rows are common.

    The first item is the row between both triangles, because it changes the coefficient of the others.
    """
    for p in range(begin, end):
        s.mark[rows[p]] = -1
    for p in range(next_begin, next_end):
        s.mark[rows[p]] = -1
    after = item
    for p in range(begin, end):
        if rows[p] == between:
            after = _numbered(s, rows, p, p + 1, column, after)
    for p in range(next_begin, next_end):
        if rows[p] == between:
            after = _numbered(s, rows, p, p + 1, column, after)
    after = _numbered(s, rows, begin, end, column, after)
    after = _numbered(s, rows, next_begin, next_end, column, after)
    entries = end - begin + next_end - next_begin
    return -1 if next_begin < next_end and after - item > PIVOTS.worth_a_pair * entries else after


@compiled
def _placed(s, rows, begin, end, first_place, side):
    """Store the positions of a column's entries among the factors."""
    for p in range(begin, end):
        s.place[first_place + p - begin] = 2 * s.mark[rows[p]] + side


@compiled
def _lower_items(s, f):
    """Create the items below the pivots, from the first to the last column; return their number."""
    n = f.n
    item = 0
    j = 0
    while j < n:
        begin, end = f.l_start[j] + 1, f.l_start[j + 1]
        next_end = f.l_start[j + 2] if j + 1 < n else end
        after = _items(s, f.l_row, begin, end, min(end + 1, next_end), next_end, j, j + 1, item)
        width = 2 if after >= 0 and j + 1 < n else 1
        if after < 0:
            after = _items(s, f.l_row, begin, end, end, end, j, j + 1, item)
        for side in range(width):
            column = j + side
            s.item_start[column], s.item_end[column] = item, after
            s.side[column] = SECOND if side else FIRST
            _placed(s, f.l_row, f.l_start[column] + 1, f.l_start[column + 1], f.l_start[column] - column, side)
        item = after
        j += width
    return item


@compiled
def _upper_items(s, f, item):
    """Create the items above the pivots, from the last to the first column; return the number of all items."""
    n_lower = f.l_start[f.n] - f.n
    j = f.n - 1
    while j >= 0:
        begin, end = f.u_start[j], f.u_start[j + 1] - 1
        first = j - 1 if j > 0 else 0
        after = -1
        if j > 0:
            after = _items(s, f.u_row, f.u_start[first], begin - 1, begin, end, first, first, item)
        width = 2 if after >= 0 else 1
        if after < 0:
            after = _items(s, f.u_row, begin, end, end, end, j, j, item)
        for side in range(width):
            column = j + 1 - width + side
            at = f.u_start[column]
            _placed(s, f.u_row, at, f.u_start[column + 1] - 1, n_lower + at - column, side)
        item = after
        j -= width
    return item


@compiled
def _list_memory(table, f):
    """Provide memory for the factors in `f` and their items; return False if there is not enough."""
    off_diagonal = f.l_start[f.n] + f.u_start[f.n] - 2 * f.n
    if 2 * off_diagonal + f.n > MOST_INDICES:
        return False
    if not (holds(table, ROW, off_diagonal, INDEX) and holds(table, COLUMN, off_diagonal, INDEX)):
        return False
    if not (holds(table, PLACE, off_diagonal, INDEX) and holds(table, UPDATE, f.u_start[f.n] - f.n, INDEX)):
        return False
    return holds(table, LU, 2 * off_diagonal + f.n, FLOAT)


@compiled
def _listed(s, f):
    """List the updates of the elimination for the pivots in `f`."""
    _sorted(f)
    s.n_lower = _lower_items(s, f)
    s.n_items = _upper_items(s, f, s.n_lower)
    for p in range(2 * s.n_items):
        s.lu[p] = 0.0
    count = 0
    for j in range(f.n):
        s.update_start[j] = count
        last = -1
        for p in range(f.u_start[j], f.u_start[j + 1] - 1):
            k = f.u_row[p] - (s.side[f.u_row[p]] == SECOND)
            if k != last and s.item_end[k] > s.item_start[k]:
                s.update[count] = k
                count += 1
            last = k
        column = f.order[j]
        for p in range(f.a_start[column], f.a_start[column + 1]):
            s.slot[p] = f.pivot[f.a_row[p]]
            s.weight[p] = f.scale[f.a_row[p]] * f.scale[column]
    s.update_start[f.n] = count


@compiled
def _reduced(s, x, j):
    """Update a column x of the matrix by all columns before it."""
    lu = s.lu
    for r in range(s.update_start[j], s.update_start[j + 1]):
        k = s.update[r]
        item = s.item_start[k]
        first = x[k]
        second = x[k + 1] if k + 1 < j else 0.0
        x[s.row[item]] -= lu[2 * item] * first + lu[2 * item + 1] * second
        second = x[k + 1] if k + 1 < j else 0.0  # may have changed by the first item
        for below in range(item + 1, s.item_end[k]):
            x[s.row[below]] -= lu[2 * below] * first + lu[2 * below + 1] * second


@compiled
def _eliminated(s, f):
    """Factor the matrix in `f` by the list; return False if a pivot is too small."""
    n = f.n
    lu, x = s.lu, f.work
    above = f.l_start[n] - n
    diagonal = 2 * s.n_items
    largest = 0.0
    for j in range(n):
        column = f.order[j]
        for p in range(f.a_start[column], f.a_start[column + 1]):
            x[s.slot[p]] += s.weight[p] * f.a[p]
        _reduced(s, x, j)
        inverse = 1.0 / x[j]
        lu[diagonal + j] = inverse
        x[j] = 0.0
        for p in range(f.u_start[j], f.u_start[j + 1] - 1):
            row = f.u_row[p]
            lu[s.place[above + p - j]] = x[row] * lu[diagonal + row]
            x[row] = 0.0
        for p in range(f.l_start[j] + 1, f.l_start[j + 1]):
            row = f.l_row[p]
            value = x[row] * inverse
            lu[s.place[p - j - 1]] = value
            largest = max(largest, abs(value))
            x[row] = 0.0
        if not (largest < PIVOTS.largest and abs(inverse) < float("inf")):
            return False
    return True


def setup(solver, matrix):
    """Set up the linear solver (SUNLinSolSetup): factors in the known order, or in a new one."""
    table = ints(solver[CONTENT])
    known = paired_view(table)
    if known.ready and _eliminated(known, factors_view(known.factors)):
        return int32(OK)
    known.ready = 0
    outcome = factored_anew(known.factors, known.weight)
    if outcome == DONE and not _list_memory(table, factors_view(known.factors)):
        outcome = FULL
    known.last_flag = outcome  # returned by SUNLinSolLastFlag
    if outcome != DONE:
        return int32(FAILED if outcome == FULL else RECOVERABLE)
    s = paired_view(table)  # the memory may have grown
    f = factors_view(s.factors)
    _listed(s, f)
    s.ready = 1
    return int32(OK if _eliminated(s, f) else RECOVERABLE)


def solve(solver, matrix, x, b, tolerance):
    """Solve A x = b (SUNLinSolSolve)."""
    s = paired_view(ints(solver[CONTENT]))
    f = factors_view(s.factors)
    into, of = floats(call_address(s.array_of, x)), floats(call_address(s.array_of, b))
    n = f.n
    lu = s.lu
    y = s.x
    n_lower = s.n_lower
    n_items = s.n_items
    for k in range(n):
        y[f.pivot[k]] = f.scale[k] * of[k]
    for item in range(n_lower):
        k = s.column[item]
        y[s.row[item]] -= lu[2 * item] * y[k] + lu[2 * item + 1] * y[k + 1]
    inverse = shifted(lu, 2 * n_items)
    for k in range(n):
        y[k] *= inverse[k]
    for item in range(n_lower, n_items):
        k = s.column[item]
        y[s.row[item]] -= lu[2 * item] * y[k] + lu[2 * item + 1] * y[k + 1]
    for k in range(n):
        into[f.order[k]] = f.scale[f.order[k]] * y[k]
    return int32(OK)
