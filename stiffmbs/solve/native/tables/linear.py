"""Tables of linear solvers: those of IDA's steps, and those of the block systems of the dynamics."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import (
    FLOAT_CELL,
    FLOATS,
    INDICES,
    INT,
    INT_CELL,
    INTS,
    OWN_FLOATS,
    OWN_INDICES,
    Layout,
)

FIXED_ORDER = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "slot": INDICES, "weight": FLOATS,
    "ready": INT_CELL, "n_lower": INT_CELL, "n_upper": INT_CELL,
    "lu": OWN_FLOATS, "row": OWN_INDICES, "column": OWN_INDICES, "update_start": INTS, "update": OWN_INDICES, "mark": INTS, "x": FLOATS,
})  # fmt: skip
"""Linear solver of IDA with fixed pivots (`stiffmbs.solve.native.fixed_order`).  It begins like the content of the
SUNDIALS solver that it replaces: number of unknowns, pivots, last flag.  `ready` is 1 if pivots are known; `n_lower`
and `n_upper` count the entries off the diagonal.  Long lists have 32-bit numbers to save memory access."""

PAIRED_COLUMNS = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "slot": INDICES, "weight": FLOATS,
    "ready": INT_CELL, "n_lower": INT_CELL, "n_items": INT_CELL,
    "lu": OWN_FLOATS, "row": OWN_INDICES, "column": OWN_INDICES, "place": OWN_INDICES, "update_start": INTS, "update": OWN_INDICES,
    "item_start": INTS, "item_end": INTS, "side": INTS, "mark": INTS, "x": FLOATS,
})  # fmt: skip
"""Linear solver with two-column supernodes, `n_items` in all (`stiffmbs.solve.native.paired_columns`)."""

BLOCK_LU = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "with_pivots": INTS,
    "compile_pivots": INT_CELL, "setup_pivots": INT_CELL, "solve_pivots": INT_CELL,
    "ready": INT_CELL, "panels": INT_CELL, "pivoted": INT_CELL, "waits": INT_CELL, "serves": INT_CELL, "refused": INT_CELL, "refined": INT_CELL,
    "n_nodes": INT, "size": INTS, "start": INTS, "down_width": INTS, "right_width": INTS, "node_start": INTS, "place": INTS,
    "n_lu": INT, "lu": OWN_FLOATS, "slot": INDICES, "update_end": INTS, "update": INDICES,
    "down_at": INTS, "down_x": INTS, "right_at": INTS, "right_x": INTS, "x": FLOATS, "scratch": FLOATS,
    "order": INTS, "unit": FLOATS, "behind": FLOATS, "kind": INTS, "n_diagonal": INT, "diagonal": INTS, "state": FLOATS,
    "pivot": FLOATS, "tried": FLOATS, "trial": FLOATS, "product": FLOATS, "terms": FLOATS, "allowed": FLOATS,
})  # fmt: skip
"""Linear solver by dense blocks (`stiffmbs.solve.linear.native.block_lu`).  `with_pivots` holds the address of the
table of `PAIRED_COLUMNS` that replaces inaccurate blocks; `compile_pivots` is the C function that stores the addresses
of its routines in the next two cells.  `ready` is 1 if the counts are of this run.  `pivoted` is 1 for current factors
with pivoting, `waits` the number of further ones, `serves` that of factorisations covered by the last trial, `refused`
that of failed trials.  `refined` is 1 if solutions are refined; `panels` is the start of the factors.  `order` holds
the pivot rows of a supernode; `unit` and `behind` are the rows of an identity matrix and of ones above its diagonal."""

DYNAMICS = Layout({
    "state": INTS, "positions": INTS, "position_factors": INTS, "velocities": INTS, "velocity_factors": INTS,
    "accelerations": INTS, "acceleration_factors": INTS, "status": INT_CELL,
    "n_behind": INT, "behind_source": INTS, "behind_row": INTS, "by_reactions": INT,
    "n_algebraic": INT, "algebraic": INTS, "algebraic_scale": FLOATS, "algebraic_before": FLOATS,
    "n_turned_for_output": INT, "turned_for_output": INTS,
    "eliminates": INT, "eliminated": INTS, "by_elimination": INT_CELL,
})  # fmt: skip
"""Tables of a state and its three block systems.  `status` receives the reason of a failure in output rows.  `behind`
lists the rates of revolution counters and states among the acceleration terms; `by_reactions` is 1 if any depends on
multipliers.  `algebraic` lists the algebraic states among the coordinates, with their scales and last values, and
`turned_for_output` the first coordinates of bodies whose orientation only output terms need.  `eliminates` is 1 if
elimination is tried first (`stiffmbs.solve.native.consistent`), `by_elimination` if it gave the last accelerations."""

ELIMINATED = Layout({
    "state": INTS, "n_u": INT, "trees": INT, "by_blocks": INT, "by_pins": INT, "lists": INTS,
    "ready": INT_CELL, "kept": FLOAT_CELL, "most_kept": FLOAT_CELL,
    "n_f": INT, "f_source": INDICES, "f_row": INDICES, "scale": FLOATS, "a": FLOATS,
    "attempt": INT_CELL, "move": INT_CELL, "q_before": FLOATS, "u_before": FLOATS, "left": FLOATS, "sizes": FLOATS, "least": FLOAT_CELL,
})  # fmt: skip
"""Elimination of J M^-1 J^T (`stiffmbs.solve.linear.eliminated`).  `trees` is 1 if no joint closes a loop; `by_blocks`
and `by_pins` select the table `lists`.  `ready` is 1 if there are factors; `kept` and `most_kept` are the relative
sizes of their pivots now and at most.  Then follow forces, M^-1/2, accelerations; addresses of routines; memory of a
state; residuals of the block system, sizes of their terms, and the least allowed residual."""

ENTRY_ELIMINATION = Layout({
    "n": INT, "n_gamma": INT, "n_j": INT, "n_slots": INT, "gamma_source": INDICES, "gamma_row": INDICES,
    "j_source": INDICES, "j_row": INDICES, "j_column": INDICES, "at_lam": INTS,
    "product_end": INDICES, "product_first": INDICES, "product_second": INDICES,
    "column_start": INDICES, "row": INDICES, "update_slot": INDICES,
    "j_scale": FLOATS, "j": FLOATS, "s": FLOATS, "l": FLOATS, "diagonal": FLOATS, "b": FLOATS,
})  # fmt: skip
"""Matrix and factors by flat lists (`stiffmbs.solve.linear.matrix_entries`)."""

PIN_ELIMINATION = Layout({
    "n": INT, "n_beside": INT, "pin": INDICES, "inverse": FLOATS, "w": FLOATS, "product": INDICES, "mass": FLOATS,
    "start": INDICES, "later": INDICES, "update": INDICES,
    "block": FLOATS, "diagonal": FLOATS, "beside": FLOATS, "scaled": FLOATS, "x": FLOATS,
})  # fmt: skip
"""Matrix and factors of planar revolute joints in the order of elimination (`stiffmbs.solve.linear.pins`).  Rows of
`pin`: starts of two entries of J for both equations of the first body and of the second; two sources of gamma; first
velocities of both bodies; first equation.  `inverse` holds the inverse masses of both bodies.  Off-diagonal blocks are
stored joint by joint from `start` on, each with its `later` joint.  Rows of `product` list the blocks of J M^-1 that
form them, `mass` the masses between these; `update` lists the block that two blocks of a joint update."""

BLOCK_ELIMINATION = Layout({
    "n_gamma": INT, "gamma_source": INDICES, "gamma_place": INDICES,
    "n_first": INT, "n_j": INT, "j_source": INDICES, "j_at": INDICES, "j_scale": FLOATS, "j": FLOATS,
    "n_full": INT, "full": INDICES, "n_diagonals": INT, "straight": INDICES, "scale": FLOATS,
    "n_pairs": INT, "pair": INDICES, "n_singles": INT, "single": INDICES,
    "n_forming": INT, "forming": INDICES, "n_products": INT, "product": INDICES,
    "n_nodes": INT, "node": INDICES, "n_panels": INT, "blocks": FLOATS, "update": INDICES, "right": INDICES,
    "place": INTS, "n_pivots": INT, "pivot": FLOATS, "diagonal": FLOATS, "n_x": INT, "x": FLOATS, "y": FLOATS,
})  # fmt: skip
"""Matrix and factors by dense blocks, for groups of three velocities (`stiffmbs.solve.linear.joint_blocks`).  Rows of
`full`, for velocities with entries of J in all rows of a joint: number of rows; start and stride of the joint's panel;
position in x; block of J; first velocity; start of each row's entries among the values.  Rows of `straight`, for
velocities with one entry each, on a diagonal: position and step in the panel; position in x; position and step in J;
first velocity; three sources.  All other entries are copied into J one by one.  Rows of `pair`: a joint's position in
x; its block of J for three velocities; the first velocity; the block's width.  Rows of `single`, for at most one entry
per velocity: position in x, entry, velocity.  Rows of `forming`: shape; target and stride; both factors with strides.
Rows of `product`: target and factors for two single entries.  Rows of `node`: size, width, start and stride of the
panel; start and width of the eliminated right blocks divided by pivots; position in x; first pivot; ends of its rows in
`update` (shape, target, stride, both factors) and in `right`, which holds the positions in x of right blocks."""
