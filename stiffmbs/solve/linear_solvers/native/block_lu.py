"""Linear solver for IDA: sparse LU by dense blocks of bodies and joints in a fixed order.

Each supernode is factored with pivots from its own rows (`stiffmbs.solve.linear_solvers.native.node_factors`).  Updates of
later blocks are lists of small dense products (`stiffmbs.sparse.block_updates`).  Only the order avoids singular
blocks (`stiffmbs.sparse.elimination_order`), so a trial solution checks the factors by its residual.  If that is
too large, solutions are refined once, or pivoting over all rows replaces these factors
(`stiffmbs.solve.linear_solvers.native.sparse_lu`).  No new trial is made while all pivots stay close to those of the last one.

References
----------
Duff and Reid, The multifrontal solution of unsymmetric sets of linear equations, SIAM J. Sci. Stat. Comput. 5 (1984)
633-641.
"""

from stiffmbs.compile.machine.layout import CACHE_LINE
from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, ints, shifted, view_of
from stiffmbs.compile.machine.native.calls import call_address, call_int, int32
from stiffmbs.compile.machine.native.factors import FULL
from stiffmbs.compile.machine.native.memory import FLOAT, holds
from stiffmbs.compile.machine.native.statuses import CONTENT, FAILED, NOT_COMPILED, OK
from stiffmbs.solve.linear_solvers.native.block_trial import panel, refine, solved, trusted
from stiffmbs.solve.linear_solvers.native.layouts import BLOCK_LU
from stiffmbs.solve.linear_solvers.native.node_factors import (
    add_one_quad,
    add_one_quad_of_pairs,
    add_two_quads,
    add_two_quads_of_pairs,
    inverted,
    multiplied,
    pair,
    single,
    triangular,
)
from stiffmbs.solve.linear_solvers.native.parameters import PIVOTS
from stiffmbs.solve.linear_solvers.native.sparse_lu import sparse_view
from stiffmbs.sparse import block_updates

LU = list(BLOCK_LU).index("lu")
SHAPES = len(block_updates.SHAPES)

block_view = view_of("BlockLU", BLOCK_LU)


@compiled
def _taken_out(s, k, parts):
    """Update later blocks by the elimination of supernode k, shape by shape."""
    # Right-looking elimination, A_ij -= L_ik U_kj for all later i and j.  The rows right of the diagonal hold -U
    # (`multiplied`), so that every update is a sum of products.  One shape at a time: its loop has no branches.
    depth = s.size[k]
    at = s.update_end[SHAPES * k - 1] if k > 0 else 0
    for kind in range(2):
        a_stride = s.right_width[k] if kind == 0 else s.down_width[k]
        b_stride = s.down_width[k] if kind == 0 else s.right_width[k]
        for rows in range(4, 0, -1):
            shape = SHAPES * k + 8 * kind + 8 - 2 * rows  # of two quads in `block_updates.SHAPES`; one quad follows
            for place in range(at, s.update_end[shape]):
                u = shifted(s.update, 4 * place)
                a, b = panel(s, u[2]), panel(s, u[3])
                if parts() == 2:
                    add_two_quads_of_pairs(rows, panel(s, u[0]), u[1], a, a_stride, b, b_stride, depth)
                else:
                    add_two_quads(rows, panel(s, u[0]), u[1], a, a_stride, b, b_stride, depth)
            for place in range(s.update_end[shape], s.update_end[shape + 1]):
                u = shifted(s.update, 4 * place)
                a, b = panel(s, u[2]), panel(s, u[3])
                if parts() == 2:
                    add_one_quad_of_pairs(rows, panel(s, u[0]), u[1], a, a_stride, b, b_stride, depth)
                else:
                    add_one_quad(rows, panel(s, u[0]), u[1], a, a_stride, b, b_stride, depth)
            at = s.update_end[shape + 1]


@compiled
def _factor_node(s, k, first, parts):
    """Factor supernode k; its pivots are stored from unknown `first` on."""
    down, right = panel(s, s.start[2 * k]), panel(s, s.start[2 * k + 1])
    size, width, stride = s.size[k], s.node_start[k + 1] - s.node_start[k], s.down_width[k]
    lower = shifted(right, size * s.right_width[k])  # L^-1 P is stored after the rows right of the diagonal
    triangular(s, down, stride, lower, width, size, first, parts)
    inverted(s, down, stride, width, size, parts)
    multiplied(s, lower, width, right, s.right_width[k], size, parts)


@compiled
def _eliminated(s, f, parts):
    panels = floats(s.panels)
    for p in range(s.n_lu):  # fill-in, and lanes without an unknown
        panels[p] = 0.0
    # The second column of a complex number repeats the first one: the slot of its entries is the number after the panels.
    for p in range(f.a_start[f.n]):
        panels[s.slot[p]] = f.a[p]
    first = 0
    for k in range(s.n_nodes):
        _factor_node(s, k, first, parts)
        _taken_out(s, k, parts)
        first += s.size[k]


@compiled
def _forget(s):
    s.waits = 0
    s.serves = 0
    s.refused = 0
    s.refined = 0
    s.ready = 1
    factors_view(s.factors).ready = 0


@compiled
def _has_pivots(s):
    """Return True if the routines with pivoting are available; they are compiled at the first request."""
    if s.solve_pivots == 0:
        call_int(s.compile_pivots, ())
    return s.solve_pivots != 0


def setup(solver, matrix):
    """Set up the linear solver (SUNLinSolSetup): factors without pivoting if trusted, otherwise with pivoting."""
    table = ints(solver[CONTENT])
    begun = block_view(table)
    if not begun.ready:
        _forget(begun)
        if not holds(table, LU, begun.n_lu + CACHE_LINE // FLOAT, FLOAT):
            begun.ready = 0
            begun.last_flag = FULL
            return int32(FAILED)
    s = block_view(table)  # the memory may have moved
    s.panels = table[LU] + (-table[LU]) % CACHE_LINE  # access to quads across lines is slow
    s.pivoted = 0
    # The k-th refusal is followed by k factorisations with pivots, up to a limit, before blocks are tried again: a pose
    # passes, but where blocks do not suit a scene, trials in vain would double the cost.
    if s.waits > 0:
        s.waits -= 1
    else:
        f = factors_view(s.factors)
        if s.parts == 1:
            _eliminated(s, f, single)
        else:
            _eliminated(s, f, pair)
        if trusted(s, f):
            return int32(OK)
        s.refused += 1
        s.waits = min(s.refused, PIVOTS.most_between_trials)
    s.pivoted = 1
    if not _has_pivots(s):
        s.last_flag = NOT_COMPILED
        return int32(FAILED)
    outcome = call_int(s.setup_pivots, (s.with_pivots, matrix))
    s.last_flag = sparse_view(ints(s.with_pivots[CONTENT])).last_flag
    return int32(outcome)


def solve(solver, matrix, x, b, tolerance):
    """Solve A x = b (SUNLinSolSolve)."""
    s = block_view(ints(solver[CONTENT]))
    if s.pivoted:
        return int32(call_int(s.solve_pivots, (s.with_pivots, matrix, x, b, tolerance)))
    into, of = floats(call_address(s.array_of, x)), floats(call_address(s.array_of, b))
    solved(s, of)
    for j in range(s.n):
        into[j] = s.x[s.place[j]]
    if s.refined:
        refine(s, into, of)
    return int32(OK)
