"""How compiled routines end, zero or a count, or one of these failures; and what SUNDIALS' headers number.

Python reads them too, so nothing of the compiler is imported here; `stiffmbs.solve.failures` puts them into words.
"""

SINGULAR = -1
"""The block system has no unique solution."""
NO_CONVERGENCE = -2
"""Newton's moves do not come to the position constraints."""
NOT_FINITE = -3
"""An equation or a solution is not a finite number."""
NO_BALANCE = -6
"""Friction and the reactions that press it have no unique common solution, or the iteration does not find it."""
NO_MEMORY = -7
"""There is too little memory for the factors of a block system."""
NO_STATE = -8
"""The equations of algebraic states have no unique solution near their last values, or Newton's iteration does not find it."""
NOT_FINITE_WITHIN = -9
"""A stage of the interpolant of an explicit step is not a finite number; the step itself is."""

STEP_TOO_SMALL, STIFF = -4, -5
PAUSED, AT_END, AT_EVENT, UNSTABLE = 0, 1, 2, 3
"""Of a call for explicit steps: to be called again, done, stopped where a force changes its law, and to be called again with a bound on steps."""

OK, RECOVERABLE, FAILED = 0, 1, -1
"""What a callback of SUNDIALS returns: after a recoverable failure IDA tries a smaller step."""
NOT_COMPILED = 3
"""Last flag of a linear solver that asked for routines in vain (`stiffmbs.solve.ida.when_needed`)."""
ONE_STEP, STOP_RETURN, ROOT_RETURN = 2, 1, 2
"""IDA_ONE_STEP, IDA_TSTOP_RETURN and IDA_ROOT_RETURN of ida.h."""
CONTENT, OPERATIONS = 0, 1
"""Words of a solver, or a vector, of SUNDIALS: its content, its table of operations."""
NORM_TABLE = 53
"""Word of a vector's operations that holds N_VBufPack, which IDA never calls: the address of the table of
`stiffmbs.solve.native.error_norm` takes its place (`stiffmbs.solve.ida.operations.take_norm`)."""
