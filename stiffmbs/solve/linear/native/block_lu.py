"""Sparse LU by dense blocks of bodies and joints along a fixed order, without pivoting: a linear solver for IDA.

Each node's diagonal block is inverted and its rows multiplied by that; what its elimination takes out of later blocks is a
list of small dense products (`stiffmbs.solve.linear.block_updates`).  The order alone keeps pivots away from zero
(`stiffmbs.solve.linear.elimination_order`), so the factors are tried: on a state of the system's own size, by the
residual that they leave.  Where that is too large, solutions are refined once, or factors with pivots take their place
(`stiffmbs.solve.native.paired_columns`).  While all pivots stay near those of the last trial, no other is made.

References
----------
Duff and Reid, The multifrontal solution of unsymmetric sets of linear equations, SIAM J. Sci. Stat. Comput. 5 (1984) 633-641.
Oettli and Prager, Compatibility of approximate solution of linear equations, Numer. Math. 6 (1964) 405-409: the residual's measure.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, ints, shifted, view_of
from stiffmbs.compile.machine.native.factors import FULL
from stiffmbs.compile.machine.native.memory import FLOAT, holds
from stiffmbs.compile.machine.native.quads import add_products, plus_product, quad, set_quad, spread, sum_of
from stiffmbs.solve.native.calls import call_address, call_int, int32
from stiffmbs.solve.native.paired_columns import paired_view
from stiffmbs.solve.native.statuses import CONTENT, FAILED, NOT_COMPILED, OK
from stiffmbs.solve.native.tables.linear import BLOCK_LU

LU = list(BLOCK_LU).index("lu")
LARGEST_RESIDUAL, REFINABLE = 1e-9, 1e-7
"""Part of the sizes of a row's terms that a trial may leave, and from which on one refinement of each solution is not tried.  Fixed
orders leave 1e-13 to 1e-15, in long steps of a car on bushings up to 1e-8."""
CHANGED = 2.0
"""Factor by which a pivot differs from that of the last trial when the next is made."""
SERVES = 50
"""Factorisations after which it is made in any case."""
WAITS_FOR = 20
"""Factorisations with pivots before the next attempt without, at the most: one after the first refusal, two after the second, and so on."""
COORDINATE, VELOCITY = 1, 2
"""Kinds of unknowns; multipliers are 0."""
SHAPES = 16
"""`stiffmbs.solve.linear.block_updates.SHAPES`"""

block_view = view_of("BlockLU", BLOCK_LU)


@compiled
def _inverted(s, d, stride, size, first):
    """Gauss and Jordan's inverse of a node's diagonal block in its place; notes the pivots."""
    for k in range(size):
        row = k * stride
        pivot = d[row + k]
        s.pivot[first + k] = pivot
        for i in range(size):
            s.scratch[i] = -d[i * stride + k]
            d[i * stride + k] = 0.0
        d[row + k] = 1.0
        inverse = spread(1.0 / pivot)
        for at in range(0, size, 4):
            line = plus_product(spread(0.0), inverse, quad(d, row + at))
            for i in range(k):
                place = i * stride + at
                set_quad(d, place, plus_product(quad(d, place), spread(s.scratch[i]), line))
            for i in range(k + 1, size):
                place = i * stride + at
                set_quad(d, place, plus_product(quad(d, place), spread(s.scratch[i]), line))
            set_quad(d, row + at, line)


@compiled
def _two_quads(rows, into, stride, a, a_stride, b, b_stride, depth):
    """Products for one to four rows of two quads."""
    if rows == 4:
        add_products(4, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif rows == 3:
        add_products(3, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif rows == 2:
        add_products(2, 2, into, stride, a, a_stride, b, b_stride, depth)
    else:
        add_products(1, 2, into, stride, a, a_stride, b, b_stride, depth)


@compiled
def _one_quad(rows, into, stride, a, a_stride, b, b_stride, depth):
    """Products for one to four rows of a quad."""
    if rows == 4:
        add_products(4, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif rows == 3:
        add_products(3, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif rows == 2:
        add_products(2, 1, into, stride, a, a_stride, b, b_stride, depth)
    else:
        add_products(1, 1, into, stride, a, a_stride, b, b_stride, depth)


@compiled
def _multiplied(s, d, stride, u, width, size):
    """Multiply a node's rows by the inverse of its diagonal block, and by -1."""
    zero = spread(0.0)
    minus = spread(-1.0)
    for column in range(0, width, 8):
        two = column + 4 < width
        for i in range(size):
            place = i * width + column
            set_quad(s.scratch, 8 * i, plus_product(zero, minus, quad(u, place)))
            set_quad(u, place, zero)
            if two:
                set_quad(s.scratch, 8 * i + 4, plus_product(zero, minus, quad(u, place + 4)))
                set_quad(u, place + 4, zero)
        line = 0
        while line < size:
            left = size - line
            rows = 3 if left == 5 or left == 6 or left == 9 else min(left, 4)
            into = shifted(u, line * width + column)
            if two:
                _two_quads(rows, into, width, shifted(d, line), stride, s.scratch, 8, size)
            else:
                _one_quad(rows, into, width, shifted(d, line), stride, s.scratch, 8, size)
            line += rows


@compiled
def _taken_out(s, k):
    """Take out of later blocks what the elimination of node k makes, shape by shape."""
    depth = s.size[k]
    at = s.update_end[SHAPES * k - 1] if k > 0 else 0
    for kind in range(2):
        a_stride = s.right_width[k] if kind == 0 else s.down_width[k]
        b_stride = s.down_width[k] if kind == 0 else s.right_width[k]
        for rows in range(4, 0, -1):
            shape = SHAPES * k + 8 * kind + 8 - 2 * rows
            for place in range(at, s.update_end[shape]):
                u = shifted(s.update, 4 * place)
                a, b = shifted(s.lu, u[2]), shifted(s.lu, u[3])
                _two_quads(rows, shifted(s.lu, u[0]), u[1], a, a_stride, b, b_stride, depth)
            for place in range(s.update_end[shape], s.update_end[shape + 1]):
                u = shifted(s.update, 4 * place)
                a, b = shifted(s.lu, u[2]), shifted(s.lu, u[3])
                _one_quad(rows, shifted(s.lu, u[0]), u[1], a, a_stride, b, b_stride, depth)
            at = s.update_end[shape + 1]


@compiled
def _eliminated(s, f):
    """Factors of the matrix in `f`."""
    for p in range(s.n_lu):
        s.lu[p] = 0.0
    for p in range(f.a_start[f.n]):
        s.lu[s.slot[p]] = f.a[p]
    first = 0
    for k in range(s.n_nodes):
        down, right = shifted(s.lu, s.start[2 * k]), shifted(s.lu, s.start[2 * k + 1])
        _inverted(s, down, s.down_width[k], s.size[k], first)
        _multiplied(s, down, s.down_width[k], right, s.right_width[k], s.size[k])
        _taken_out(s, k)
        first += s.size[k]


@compiled
def _forward(s, k):
    """Multiply node k of x by the inverse of its diagonal block, and take it out of later nodes."""
    size, stride = s.size[k], s.down_width[k]
    down = shifted(s.lu, s.start[2 * k])
    own = shifted(s.x, s.node_start[k])
    width = s.node_start[k + 1] - s.node_start[k]
    for j in range(size):
        s.scratch[j] = -own[j]
    for at in range(0, width, 4):
        set_quad(own, at, spread(0.0))
        add_products(1, 1, shifted(own, at), 0, s.scratch, 1, shifted(down, at), stride, size)
    first = s.down_at[k]
    for place in range(first, s.down_at[k + 1]):
        at = width + 4 * (place - first)
        add_products(1, 1, shifted(s.x, s.down_x[place]), 0, own, 1, shifted(down, at), stride, size)
    for j in range(size):
        own[j] = -own[j]


@compiled
def _backward(s, k):
    """Complete node k of x by what is known of later nodes."""
    width = s.right_width[k]
    right = shifted(s.lu, s.start[2 * k + 1])
    own = shifted(s.x, s.node_start[k])
    first = s.right_at[k]
    for place in range(first, s.right_at[k + 1]):
        set_quad(s.scratch, 4 * (place - first), quad(s.x, s.right_x[place]))
    for i in range(s.size[k]):
        total = spread(0.0)
        for at in range(0, width, 4):
            total = plus_product(total, quad(right, i * width + at), quad(s.scratch, at))
        own[i] += sum_of(total)


@compiled
def _solved(s, of):
    """x = A^-1 b by the factors without pivots, at the places of the nodes."""
    for p in range(s.node_start[s.n_nodes]):
        s.x[p] = 0.0
    for j in range(s.n):
        s.x[s.place[j]] = of[j]
    for k in range(s.n_nodes):
        _forward(s, k)
    for k in range(s.n_nodes - 1, -1, -1):
        _backward(s, k)


@compiled
def _near_tried(s):
    """Whether no pivot has changed much since the last trial."""
    if s.serves == 0:
        return False
    s.serves -= 1
    far = 0
    for k in range(s.n):
        ratio = s.pivot[k] * s.tried[k]
        far += 0 if 1.0 / CHANGED < ratio < CHANGED else 1
    return far == 0


@compiled
def _sized(s, f):
    """A state of the system's own size in `trial`: coordinates of 1, velocities of the rate, multipliers that matter beside them."""
    rate = 0.0
    for k in range(s.n_diagonal):
        rate = max(rate, abs(f.a[s.diagonal[k]]))
    for i in range(f.n):
        s.terms[i] = 0.0
    for j in range(f.n):
        s.trial[j] = s.state[j] * (1.0 if s.kind[j] == COORDINATE else rate)
        if s.kind[j] > 0:
            for p in range(f.a_start[j], f.a_start[j + 1]):
                s.terms[f.a_row[p]] += abs(f.a[p] * s.trial[j])
    for j in range(f.n):
        if s.kind[j] == 0:
            part = 0.0
            for p in range(f.a_start[j], f.a_start[j + 1]):
                if s.kind[f.a_row[p]] > 0:
                    part = max(part, abs(f.a[p]) / s.terms[f.a_row[p]])
            s.trial[j] = s.state[j] / part if 0.0 < part < float("inf") else s.state[j]


@compiled
def _multiply(s, f, by):
    """A times a vector, in `product`, and the sizes of the terms of each row in `terms`."""
    for i in range(f.n):
        s.product[i] = 0.0
        s.terms[i] = 0.0
    for j in range(f.n):
        for p in range(f.a_start[j], f.a_start[j + 1]):
            part = f.a[p] * by[j]
            s.product[f.a_row[p]] += part
            s.terms[f.a_row[p]] += abs(part)


@compiled
def _trusted(s, f):
    """Whether the factors without pivots leave a small residual; by a trial where pivots have changed."""
    if _near_tried(s):
        return True
    _sized(s, f)
    _multiply(s, f, s.trial)
    for i in range(f.n):
        s.allowed[i] = LARGEST_RESIDUAL * s.terms[i]
    left = _left_after_solution(s, f)
    s.refined = 1 if 1.0 < left <= REFINABLE / LARGEST_RESIDUAL else 0
    if s.refined:
        left = _left_after_solution(s, f)
    for k in range(f.n):
        s.tried[k] = 1.0 / s.pivot[k]
    s.serves = SERVES if left <= 1.0 else 0
    return left <= 1.0


@compiled
def _left_after_solution(s, f):
    """Take what the factors make of `product` from the trial; the largest residual that stays, in units of what is allowed."""
    _solved(s, s.product)
    for j in range(f.n):
        s.trial[j] -= s.x[s.place[j]]
    _multiply(s, f, s.trial)
    largest = 0.0
    for i in range(f.n):
        left = 0.0 if s.product[i] == 0.0 else abs(s.product[i]) / s.allowed[i]
        if not left <= largest:
            largest = left if left < float("inf") else float("inf")  # also where it is no number
    return largest


@compiled
def _forget(s):
    """Begin a run as if there had been none before."""
    s.waits = 0
    s.serves = 0
    s.refused = 0
    s.refined = 0
    s.ready = 1
    paired_view(ints(s.with_pivots[CONTENT])).ready = 0


@compiled
def _has_pivots(s):
    """Whether the routines with pivots are at hand; few runs need them, so they are compiled when first asked for."""
    if s.solve_pivots == 0:
        call_int(s.compile_pivots, ())
    return s.solve_pivots != 0


def setup(solver, matrix):
    """SUNLinSolSetup: factors without pivots where they can be trusted, else with pivots."""
    table = ints(solver[CONTENT])
    begun = block_view(table)
    if not begun.ready:
        _forget(begun)
        if not holds(table, LU, begun.n_lu, FLOAT):
            begun.ready = 0
            begun.last_flag = FULL
            return int32(FAILED)
    s = block_view(table)  # the memory may have moved
    s.pivoted = 0
    if s.waits > 0:
        s.waits -= 1
    else:
        f = factors_view(s.factors)
        _eliminated(s, f)
        if _trusted(s, f):
            return int32(OK)
        s.refused += 1
        s.waits = min(s.refused, WAITS_FOR)
    s.pivoted = 1
    if not _has_pivots(s):
        s.last_flag = NOT_COMPILED
        return int32(FAILED)
    outcome = call_int(s.setup_pivots, (s.with_pivots, matrix))
    s.last_flag = paired_view(ints(s.with_pivots[CONTENT])).last_flag
    return int32(outcome)


def solve(solver, matrix, x, b, tolerance):
    """SUNLinSolSolve: x = A^-1 b."""
    s = block_view(ints(solver[CONTENT]))
    if s.pivoted:
        return int32(call_int(s.solve_pivots, (s.with_pivots, matrix, x, b, tolerance)))
    into, of = floats(call_address(s.array_of, x)), floats(call_address(s.array_of, b))
    _solved(s, of)
    for j in range(s.n):
        into[j] = s.x[s.place[j]]
    if s.refined:
        _refine(s, into, of)
    return int32(OK)


@compiled
def _refine(s, x, b):
    """Add to a solution what the factors make of its residual."""
    _multiply(s, factors_view(s.factors), x)
    for i in range(s.n):
        s.product[i] = b[i] - s.product[i]
    _solved(s, s.product)
    for j in range(s.n):
        x[j] += s.x[s.place[j]]
