"""Return values of compiled routines, zero, a count or one of these failures, and constants of SUNDIALS' headers.

Python reads them too, so this module imports nothing of the compiler; `stiffmbs.dynamics.storage` has the messages.
"""

from typing import Final

SINGULAR, NO_CONVERGENCE, NOT_FINITE, STEP_TOO_SMALL, STIFF, NO_BALANCE, NO_MEMORY, NO_STATE, NOT_FINITE_WITHIN = range(
    -1, -10, -1
)
"""Failures: the block system has no unique solution; Newton's iteration of the position constraints does not converge; an
equation or a solution is not finite; an explicit step is too small, or the motion too stiff for it; friction and reactions
have no unique balance, or the iteration does not find it; too little memory for the factors of a block system; algebraic
states have no unique solution near their last values, or Newton's iteration does not find it; a stage of the interpolant of
an explicit step is not finite, although the step is."""
PAUSED, AT_END, AT_EVENT, UNSTABLE = range(4)
"""Results of a call for explicit steps: to be continued, complete, at a change of law, to be continued with a bound."""

FAILED, OK, RECOVERABLE = range(-1, 2)
"""Results of SUNDIALS callbacks: after a recoverable failure, IDA tries a smaller step."""
NOT_COMPILED: Final = 3
"""Last flag of a linear solver whose request for routines has failed (`stiffmbs.solve.ida.session`)."""
ONE_STEP: Final = 2
STOP_RETURN: Final = 1
ROOT_RETURN: Final = 2
"""IDA_ONE_STEP, IDA_TSTOP_RETURN and IDA_ROOT_RETURN of ida.h."""
CONTENT, OPERATIONS = range(2)
"""Words of a SUNDIALS solver or vector: its content, its table of operations."""
NORM_TABLE: Final = 53
"""Word of N_VBufPack in a vector's operations, which IDA never calls; `stiffmbs.solve.ida.operations.take_norm` stores
the address of the table of `stiffmbs.solve.ida.native.error_norm` there."""
