"""Sparse LU factorisation of a matrix with constant pattern.

`factor` is the left-looking LU of Gilbert and Peierls with threshold partial pivoting (SIAM J. Sci. Stat. Comput. 9,
1988; in the form of Davis, Direct Methods for Sparse Linear Systems, 2006, ch. 6). `refactor` repeats the elimination
with the previous pivots. If a pivot is too small relative to its column, it stops and a new pivot search is needed.
"""

from math import log, sqrt

from .access import compiled, factors_view
from .memory import FLOAT, INT, holds
from .tables import FACTORS

KEEP_DIAGONAL = 0.1
"""Smallest diagonal pivot relative to the largest entry of its column that is preferred, to reduce fill."""
TOO_SMALL = 1e-3
"""Smallest accepted previous pivot relative to the largest entry of its column."""

DONE, SINGULAR, FULL = range(3)
"""FULL: no memory for more entries."""
L_ROW, L, U_ROW, U = (list(FACTORS).index(name) for name in ("l_row", "l", "u_row", "u"))


@compiled
def _reach(f, column):
    """Find the rows of a column's elimination, in topological order at stack[top:n]; the caller clears the marks."""
    n = f.n
    top = n
    for p in range(f.a_start[column], f.a_start[column + 1]):
        start = f.a_row[p]
        if f.stack[2 * n + start]:
            continue
        head = 0
        f.stack[n] = start  # the stack of open rows
        while head >= 0:
            row = f.stack[n + head]
            pivot = f.pivot[row]
            if not f.stack[2 * n + row]:
                f.stack[2 * n + row] = 1
                f.stack[3 * n + head] = 0 if pivot < 0 else f.l_start[pivot] + 1
            end = 0 if pivot < 0 else f.l_start[pivot + 1]
            finished = True
            for at in range(f.stack[3 * n + head], end):
                below = f.l_row[at]
                if not f.stack[2 * n + below]:
                    f.stack[3 * n + head] = at + 1
                    head += 1
                    f.stack[n + head] = below
                    finished = False
                    break
            if finished:
                head -= 1
                top -= 1
                f.stack[top] = row
    return top


@compiled
def _more_memory(table):
    """Allocate memory for the expected number of entries, or double it; return False if there is none."""
    f = factors_view(table)
    capacity = max(f.expected_entries, 2 * f.capacity)
    if not (holds(table, L_ROW, capacity, INT) and holds(table, L, capacity, FLOAT)):
        return False
    if not (holds(table, U_ROW, capacity, INT) and holds(table, U, capacity, FLOAT)):
        return False
    f.capacity = capacity
    return True


@compiled
def factor(table):
    """Find pivots and factors of the matrix, and allocate memory as needed; return DONE, SINGULAR or FULL."""
    while True:
        outcome = _factored_within(factors_view(table))
        if outcome != FULL or not _more_memory(table):
            return outcome


@compiled
def _factored_within(f):
    """Run `factor` in the available memory; return FULL if it is too small."""
    n = f.n
    for k in range(n):
        f.pivot[k] = -1
        f.work[k] = 0.0
        f.stack[2 * n + k] = 0
    l_end = 0
    u_end = 0
    f.ready = 0
    for k in range(n):
        f.l_start[k] = l_end
        f.u_start[k] = u_end
        column = f.order[k]
        f.l_start[k + 1] = l_end  # a column not factored yet must look empty
        top = _reach(f, column)
        if max(l_end, u_end) + n - top + 1 > f.capacity:  # a column has the reached rows and its pivot
            return FULL
        for at in range(top, n):
            f.work[f.stack[at]] = 0.0
        for p in range(f.a_start[column], f.a_start[column + 1]):
            f.work[f.a_row[p]] += f.a[p]
        best = -1
        largest = 0.0
        for at in range(top, n):
            row = f.stack[at]
            f.stack[2 * n + row] = 0
            pivot = f.pivot[row]
            value = f.work[row]
            if pivot < 0:
                if abs(value) > largest:
                    largest = abs(value)
                    best = row
            else:
                for p in range(f.l_start[pivot] + 1, f.l_start[pivot + 1]):
                    f.work[f.l_row[p]] -= f.l[p] * value
                f.u_row[u_end] = pivot
                f.u[u_end] = value
                u_end += 1
        if best < 0 or not largest > 0.0 or largest == float("inf"):
            return SINGULAR
        if f.pivot[column] < 0 and abs(f.work[column]) >= KEEP_DIAGONAL * largest:
            best = column
        value = f.work[best]
        f.u_row[u_end] = k
        f.u[u_end] = value
        u_end += 1
        f.pivot[best] = k
        f.l_row[l_end] = best
        f.l[l_end] = 1.0
        l_end += 1
        for at in range(top, n):
            row = f.stack[at]
            if f.pivot[row] < 0:
                f.l_row[l_end] = row
                f.l[l_end] = f.work[row] / value
                l_end += 1
            f.work[row] = 0.0
    f.l_start[n] = l_end
    f.u_start[n] = u_end
    for p in range(l_end):
        f.l_row[p] = f.pivot[f.l_row[p]]
    f.ready = 1
    return DONE


@compiled
def refactor(f):
    """Factor the matrix with the pivots of the last `factor`; return DONE, or SINGULAR if a pivot is too small."""
    n = f.n
    for k in range(n):
        column = f.order[k]
        for p in range(f.a_start[column], f.a_start[column + 1]):
            f.work[f.pivot[f.a_row[p]]] += f.a[p]
        last = f.u_start[k + 1] - 1
        for p in range(f.u_start[k], last):
            j = f.u_row[p]
            value = f.work[j]
            f.u[p] = value
            f.work[j] = 0.0
            for below in range(f.l_start[j] + 1, f.l_start[j + 1]):
                f.work[f.l_row[below]] -= f.l[below] * value
        value = f.work[k]
        f.work[k] = 0.0
        f.u[last] = value
        largest = abs(value)
        for p in range(f.l_start[k] + 1, f.l_start[k + 1]):
            largest = max(largest, abs(f.work[f.l_row[p]]))
        if not (abs(value) > TOO_SMALL * largest and largest < float("inf")):
            for i in range(n):
                f.work[i] = 0.0
            return SINGULAR
        for p in range(f.l_start[k] + 1, f.l_start[k + 1]):
            row = f.l_row[p]
            f.l[p] = f.work[row] / value
            f.work[row] = 0.0
    return DONE


@compiled
def _take_diagonal(f):
    """Copy the positive diagonal entries to `work`; others are zero."""
    for column in range(f.n):
        f.work[column] = 0.0
        for p in range(f.a_start[column], f.a_start[column + 1]):
            if f.a_row[p] == column and f.a[p] > 0.0:
                f.work[column] = f.a[p]


@compiled
def equilibrate(f):
    """Scale a block matrix [D J^T; J 0]: 1/sqrt(D) for its first unknowns, rows of unit length for its multipliers.

    The diagonal entries are then suitable pivots for masses and inertias of any size, which keeps the fill small.
    """
    _take_diagonal(f)
    _scale_by_work(f)


@compiled
def _scale_by_work(f):
    """Compute the scales from D in `work`."""
    for column in range(f.n):
        f.scale[column] = 1.0 / sqrt(f.work[column]) if f.work[column] > 0.0 else 0.0
        f.work[column] = 0.0
    for column in range(f.n):
        if f.scale[column] == 0.0:
            length = 0.0
            for p in range(f.a_start[column], f.a_start[column + 1]):
                part = f.a[p] * max(f.scale[f.a_row[p]], 0.0)
                length += part * part
            f.scale[column] = -1.0 / sqrt(length) if 0.0 < length < float("inf") else -1.0
    for k in range(f.n):
        f.scale[k] = abs(f.scale[k])


@compiled
def scale(f):
    """Multiply the matrix by the scales of its rows and columns."""
    for column in range(f.n):
        for p in range(f.a_start[column], f.a_start[column + 1]):
            f.a[p] *= f.scale[f.a_row[p]] * f.scale[column]


@compiled
def factored(table):
    """Factor the scaled block matrix with the previous scales and pivots if possible, else with new ones.

    The matrix is overwritten by the scaled matrix.
    """
    f = factors_view(table)
    if f.ready:
        scale(f)
        if refactor(f) == DONE:
            return DONE
        for column in range(f.n):
            for p in range(f.a_start[column], f.a_start[column + 1]):
                f.a[p] /= f.scale[f.a_row[p]] * f.scale[column]
    _take_diagonal(f)
    spread_inertia(f)
    _scale_by_work(f)
    scale(f)
    return factor(table)


@compiled
def solve(f, b):
    """Overwrite b by the solution of A x = b."""
    n = f.n
    for k in range(n):
        f.x[f.pivot[k]] = f.scale[k] * b[k]
    for k in range(n):
        value = f.x[k]
        for p in range(f.l_start[k] + 1, f.l_start[k + 1]):
            f.x[f.l_row[p]] -= f.l[p] * value
    for k in range(n - 1, -1, -1):
        last = f.u_start[k + 1] - 1
        value = f.x[k] / f.u[last]
        f.x[k] = value
        for p in range(f.u_start[k], last):
            f.x[f.u_row[p]] -= f.u[p] * value
    for k in range(n):
        b[f.order[k]] = f.scale[f.order[k]] * f.x[k]


@compiled
def log_determinant(f):
    """Return log |det| of the unscaled matrix."""
    total = 0.0
    product = 1.0
    for k in range(f.n):
        product *= abs(f.u[f.u_start[k + 1] - 1]) / (f.scale[k] * f.scale[k])
        if not 1e-100 < product < 1e100:
            total += log(product)
            product = 1.0
    return total + log(product)


LIGHT, SPREAD_OVER = 1e-6, 4
"""Part of the coupled inertia below which a body's own inertia is replaced; number of joints it spreads over."""
COUPLES = 0.1
"""Part of an equation's largest entry above which an entry couples; smaller ones would act as huge gear ratios."""


@compiled
def spread_inertia(f):
    """Replace small inertias in `work` by the coupled ones: D_k becomes the largest D_j (J_k/J_j)^2.

    A body without inertia on a hinge moves with the hinge. Scaled by its own inertia, its acceleration would be a
    difference of large numbers.
    """
    for _ in range(SPREAD_OVER):
        for row in range(f.n):
            if f.work[row] == 0.0:
                _spread(f, row)


@compiled
def _spread(f, row):
    """Spread inertia along one equation, whose row of J is its column in the symmetric matrix."""
    largest = 0.0
    for p in range(f.a_start[row], f.a_start[row + 1]):
        largest = max(largest, abs(f.a[p]))
    heaviest = 0.0
    for p in range(f.a_start[row], f.a_start[row + 1]):
        k = f.a_row[p]
        if abs(f.a[p]) > COUPLES * largest and f.work[k] > 0.0:
            heaviest = max(heaviest, f.work[k] / (f.a[p] * f.a[p]))
    for p in range(f.a_start[row], f.a_start[row + 1]):
        k = f.a_row[p]
        coupled = heaviest * f.a[p] * f.a[p]
        if 0.0 < f.work[k] < LIGHT * coupled:
            f.work[k] = coupled
