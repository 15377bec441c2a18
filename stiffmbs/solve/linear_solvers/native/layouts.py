"""Memory layouts of the linear solvers of IDA.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import FLOATS, INDICES, INT, INT_CELL, INTS, OWN_FLOATS, Layout

SPARSE_LU = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "entries": FLOATS,
})  # fmt: skip
"""Sparse LU (`stiffmbs.solve.linear_solvers.native.sparse_lu`).  It begins like the content of the SUNDIALS solver that it
replaces: number of unknowns, pivots, last flag.  `entries` keeps those of the matrix while it is scaled."""

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
table of `SPARSE_LU` that replaces inaccurate blocks; `compile_pivots` is the C function that stores the addresses
of its routines in the next two cells.  `ready` is 1 if the counts are of this run.  `pivoted` is 1 for current factors
with pivoting, `waits` the number of further ones, `serves` that of factorisations covered by the last trial, `refused`
that of failed trials.  `refined` is 1 if solutions are refined; `panels` is the start of the factors.  `order` holds
the pivot rows of a supernode; `unit` and `above` are the rows of an identity matrix and of ones above its diagonal."""
