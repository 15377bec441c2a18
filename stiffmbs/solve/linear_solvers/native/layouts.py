"""Memory layouts of the linear solvers of IDA.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import FLOATS, INDICES, INT, INT_CELL, INTS, OWN_FLOATS, OWN_INDICES, Layout

FIXED_ORDER = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "slot": INDICES, "weight": FLOATS,
    "ready": INT_CELL, "n_lower": INT_CELL, "n_upper": INT_CELL,
    "lu": OWN_FLOATS, "row": OWN_INDICES, "column": OWN_INDICES, "update_start": INTS, "update": OWN_INDICES, "mark": INTS, "x": FLOATS,
})  # fmt: skip
"""Linear solver of IDA with fixed pivots (`stiffmbs.solve.linear_solvers.native.fixed_order`).  It begins like the content of the
SUNDIALS solver that it replaces: number of unknowns, pivots, last flag.  `ready` is 1 if pivots are known; `n_lower`
and `n_upper` count the entries off the diagonal.  Long lists have 32-bit numbers to save memory access."""

PIVOTED = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "weight": FLOATS,
})  # fmt: skip
"""Linear solver with pivots searched in every matrix (`stiffmbs.solve.linear_solvers.native.pivoted`)."""

MULTIPLIER, COORDINATE, VELOCITY = range(3)
"""Kinds of unknowns in `BLOCK_LU`."""

BLOCK_LU = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "with_pivots": INTS,
    "compile_pivots": INT_CELL, "setup_pivots": INT_CELL, "solve_pivots": INT_CELL,
    "ready": INT_CELL, "panels": INT_CELL, "pivoted": INT_CELL, "waits": INT_CELL, "serves": INT_CELL, "refused": INT_CELL, "refined": INT_CELL,
    "parts": INT, "n_nodes": INT, "size": INTS, "start": INTS, "down_width": INTS, "right_width": INTS, "node_start": INTS, "place": INTS,
    "n_lu": INT, "lu": OWN_FLOATS, "slot": INDICES, "update_end": INTS, "update": INDICES,
    "down_at": INTS, "down_x": INTS, "right_at": INTS, "right_x": INTS, "x": FLOATS, "scratch": FLOATS,
    "order": INTS, "unit": FLOATS, "above": FLOATS, "kind": INTS, "n_diagonal": INT, "diagonal": INTS, "state": FLOATS,
    "pivot": FLOATS, "tried": FLOATS, "trial": FLOATS, "product": FLOATS, "terms": FLOATS, "allowed": FLOATS,
})  # fmt: skip
"""Linear solver by dense blocks (`stiffmbs.solve.linear_solvers.native.block_lu`).  `with_pivots` holds the address of the
table of `PIVOTED` that replaces inaccurate blocks; `compile_pivots` is the C function that stores the addresses
of its routines in the next two cells.  `ready` is 1 if the counts are of this run.  `pivoted` is 1 for current factors
with pivoting, `waits` the number of further ones, `serves` that of factorisations covered by the last trial, `refused`
that of failed trials.  `refined` is 1 if solutions are refined; `panels` is the start of the factors.  `order` holds
the pivot rows of a supernode; `unit` and `above` are the rows of an identity matrix and of ones above its diagonal."""
