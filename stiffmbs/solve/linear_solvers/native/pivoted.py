"""Linear solver for IDA: sparse LU with pivots searched in every matrix, in place of inaccurate blocks."""

from stiffmbs.compile.machine.native.access import factors_view, floats, ints, view_of
from stiffmbs.compile.machine.native.calls import call_address, int32
from stiffmbs.compile.machine.native.factors import DONE, FULL
from stiffmbs.compile.machine.native.factors import solve as solve_factors
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import CONTENT, FAILED, OK, RECOVERABLE
from stiffmbs.solve.linear_solvers.native.fixed_order import refactored
from stiffmbs.solve.linear_solvers.native.layouts import PIVOTED

pivoted_view = view_of("Pivoted", PIVOTED)


def setup(solver, matrix):
    """Set up the linear solver (SUNLinSolSetup)."""
    s = pivoted_view(ints(solver[CONTENT]))
    s.last_flag = refactored(s.factors, s.weight)  # returned by SUNLinSolLastFlag
    if s.last_flag == DONE:
        return int32(OK)
    return int32(FAILED if s.last_flag == FULL else RECOVERABLE)


def solve(solver, matrix, x, b, tolerance):
    """Solve A x = b (SUNLinSolSolve)."""
    s = pivoted_view(ints(solver[CONTENT]))
    into, of = floats(call_address(s.array_of, x)), floats(call_address(s.array_of, b))
    copied(into, of, s.n)
    solve_factors(factors_view(s.factors), into)
    return int32(OK)
