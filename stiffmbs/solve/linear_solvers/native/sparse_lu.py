"""Linear solver for IDA: sparse LU of `stiffmbs.compile.machine.native.factors`, with pivots searched only where they become too small."""

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, ints, view_of
from stiffmbs.compile.machine.native.calls import call_address, int32
from stiffmbs.compile.machine.native.factors import DONE, FULL, SINGULAR, equilibrate, factor, refactor, scale
from stiffmbs.compile.machine.native.factors import solve as solve_factors
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import CONTENT, FAILED, OK, RECOVERABLE
from stiffmbs.solve.linear_solvers.native.layouts import SPARSE_LU

sparse_view = view_of("SparseLU", SPARSE_LU)


@compiled
def factored(factors, kept):
    """Factor the matrix, which is temporarily scaled, with known pivots if possible; return the outcome."""
    f = factors_view(factors)
    copied(kept, f.a, f.a_start[f.n])
    outcome = SINGULAR
    if f.ready:
        scale(f)
        outcome = refactor(f)
        copied(f.a, kept, f.a_start[f.n])
    if outcome != DONE:
        equilibrate(f)
        scale(f)
        outcome = factor(factors)
        copied(f.a, kept, f.a_start[f.n])
    return outcome


def setup(solver, matrix):
    """Set up the linear solver (SUNLinSolSetup)."""
    s = sparse_view(ints(solver[CONTENT]))
    s.last_flag = factored(s.factors, s.entries)  # returned by SUNLinSolLastFlag
    if s.last_flag == DONE:
        return int32(OK)
    return int32(FAILED if s.last_flag == FULL else RECOVERABLE)


def solve(solver, matrix, x, b, tolerance):
    """Solve A x = b (SUNLinSolSolve)."""
    s = sparse_view(ints(solver[CONTENT]))
    into, of = floats(call_address(s.array_of, x)), floats(call_address(s.array_of, b))
    copied(into, of, s.n)
    solve_factors(factors_view(s.factors), into)
    return int32(OK)
