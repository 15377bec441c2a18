"""Return values of compiled routines, zero, a count or one of these failures, and constants of SUNDIALS' headers.

Python reads them too, so this module imports nothing of the compiler; `stiffmbs.solve.failures` has the messages.
"""

SINGULAR = -1
"""The block system has no unique solution."""
NO_CONVERGENCE = -2
"""The Newton iteration of the position constraints does not converge."""
NOT_FINITE = -3
"""An equation or a solution is not finite."""
NO_BALANCE = -6
"""Friction and reactions have no unique solution, or the iteration does not find it."""
NO_MEMORY = -7
"""Memory for the factors of a block system is insufficient."""
NO_STATE = -8
"""Algebraic states have no unique solution near their last values, or Newton's iteration does not find it."""
NOT_FINITE_WITHIN = -9
"""A stage of the interpolant of an explicit step is not finite, although the step is."""

STEP_TOO_SMALL, STIFF = -4, -5
PAUSED, AT_END, AT_EVENT, UNSTABLE = 0, 1, 2, 3
"""Results of a call for explicit steps: to be continued, complete, at a change of law, to be continued with a bound."""

OK, RECOVERABLE, FAILED = 0, 1, -1
"""Results of SUNDIALS callbacks: after a recoverable failure, IDA tries a smaller step."""
NOT_COMPILED = 3
"""Last flag of a linear solver whose request for routines has failed (`stiffmbs.solve.ida.when_needed`)."""
ONE_STEP, STOP_RETURN, ROOT_RETURN = 2, 1, 2
"""IDA_ONE_STEP, IDA_TSTOP_RETURN and IDA_ROOT_RETURN of ida.h."""
CONTENT, OPERATIONS = 0, 1
"""Words of a SUNDIALS solver or vector: its content, its table of operations."""
NORM_TABLE = 53
"""Word of N_VBufPack in a vector's operations, which IDA never calls; `stiffmbs.solve.ida.operations.take_norm` stores
the address of the table of `stiffmbs.solve.native.error_norm` there."""
