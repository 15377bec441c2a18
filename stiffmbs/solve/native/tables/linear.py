"""What compiled code works on as it solves linear equations: those of IDA's steps, and the block systems of the dynamics."""

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
"""A linear solver of IDA's along fixed pivots (`stiffmbs.solve.native.fixed_order`); it begins as the content of the
solver of SUNDIALS whose place it takes: number of unknowns, pivots, last flag.  `ready` says whether pivots are known;
`n_lower` and `n_upper` count the entries beside the diagonal.  Its long lists are of 32-bit numbers: a long
chain's solutions wait for memory."""

PAIRED_COLUMNS = Layout({
    "n": INT, "pivots": INT, "last_flag": INT_CELL, "array_of": INT, "factors": INTS, "slot": INDICES, "weight": FLOATS,
    "ready": INT_CELL, "n_lower": INT_CELL, "n_items": INT_CELL,
    "lu": OWN_FLOATS, "row": OWN_INDICES, "column": OWN_INDICES, "place": OWN_INDICES, "update_start": INTS, "update": OWN_INDICES,
    "item_start": INTS, "item_end": INTS, "side": INTS, "mark": INTS, "x": FLOATS,
})  # fmt: skip
"""The same with its columns in pairs, `n_items` in all (`stiffmbs.solve.native.paired_columns`)."""

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
"""The same by dense blocks (`stiffmbs.solve.linear.native.block_lu`); `with_pivots` holds the address of the table
of columns in pairs that takes over where those cannot be trusted, `compile_pivots` that of the C function that puts the addresses of
its routines into the next two cells.  `ready` says whether the counts are of this run: whether the factors at
hand are those with pivots, how many more are, how many factorisations the last trial serves for yet, trials that were failed, and
whether solutions are refined; `panels` is where the factors begin in `lu`.  `order` tells which rows a node's pivots were found in;
`unit` and `behind` are the rows of a unit matrix and of ones above its diagonal."""

DYNAMICS = Layout({
    "state": INTS, "positions": INTS, "position_factors": INTS, "velocities": INTS, "velocity_factors": INTS,
    "accelerations": INTS, "acceleration_factors": INTS, "status": INT_CELL,
    "n_behind": INT, "behind_source": INTS, "behind_row": INTS, "by_reactions": INT,
    "n_algebraic": INT, "algebraic": INTS, "algebraic_scale": FLOATS, "algebraic_before": FLOATS,
    "n_turned_for_output": INT, "turned_for_output": INTS,
    "eliminates": INT, "eliminated": INTS, "by_elimination": INT_CELL,
})  # fmt: skip
"""The tables of one state and its three block systems; `status` receives why no more instants could be reported;
`behind` tells where the rates of counters of turns and states stand among the terms of accelerations, and `by_reactions` whether any of them
depends on multipliers; then the coordinates that are algebraic states, sizes of them that matter, and their last values; and the
bodies whose orientation output terms ask for beside those that accelerations do, by their first coordinates.  At last whether
accelerations are tried by elimination (`stiffmbs.solve.native.consistent`), its table, and whether it has found the last ones."""

ELIMINATED = Layout({
    "state": INTS, "n_u": INT, "trees": INT, "by_blocks": INT, "by_pins": INT, "lists": INTS,
    "ready": INT_CELL, "kept": FLOAT_CELL, "most_kept": FLOAT_CELL,
    "n_f": INT, "f_source": INDICES, "f_row": INDICES, "scale": FLOATS, "a": FLOATS,
    "attempt": INT_CELL, "move": INT_CELL, "q_before": FLOATS, "u_before": FLOATS, "left": FLOATS, "sizes": FLOATS, "least": FLOAT_CELL,
})  # fmt: skip
"""J M^-1 J^T (`stiffmbs.solve.linear.eliminated`): whether no joint closes a loop, whether it is factored by blocks or by pins, and the table of
these or of the entries; whether there are factors, what their pivots keep, and have kept at the most; forces, M^-1/2, accelerations;
the addresses of its routines, where other compiled code may ask for them, memory of a state, what the block system leaves and the sizes of its terms, and what may be left
of small ones."""

ENTRY_ELIMINATION = Layout({
    "n": INT, "n_gamma": INT, "n_j": INT, "n_slots": INT, "gamma_source": INDICES, "gamma_row": INDICES,
    "j_source": INDICES, "j_row": INDICES, "j_column": INDICES, "at_lam": INTS,
    "product_end": INDICES, "product_first": INDICES, "product_second": INDICES,
    "column_start": INDICES, "row": INDICES, "update_slot": INDICES,
    "j_scale": FLOATS, "j": FLOATS, "s": FLOATS, "l": FLOATS, "diagonal": FLOATS, "b": FLOATS,
})  # fmt: skip
"""The matrix and its factors by flat lists (`stiffmbs.solve.linear.matrix_entries`)."""

PIN_ELIMINATION = Layout({
    "n": INT, "n_beside": INT, "pin": INDICES, "inverse": FLOATS, "w": FLOATS, "product": INDICES, "mass": FLOATS,
    "start": INDICES, "later": INDICES, "update": INDICES,
    "block": FLOATS, "diagonal": FLOATS, "beside": FLOATS, "scaled": FLOATS, "x": FLOATS,
})  # fmt: skip
"""The same where all joints are planar pins (`stiffmbs.solve.linear.pins`), in the order of their elimination.  Rows of `pin`: where two
entries of J begin for the first body and both equations, and for the second; two sources of gamma; the first velocities of both bodies;
the first equation.  `inverse` holds the inverse masses of both bodies.  Blocks beside the diagonal stand pin after pin from `start` on, each
with the later pin that it belongs to; rows of `product` tell which blocks of J M^-1 each begins with, `mass` what lies between these;
`update` tells the block that two blocks of a pin change."""

BLOCK_ELIMINATION = Layout({
    "n_gamma": INT, "gamma_source": INDICES, "gamma_place": INDICES,
    "n_first": INT, "n_j": INT, "j_source": INDICES, "j_at": INDICES, "j_scale": FLOATS, "j": FLOATS,
    "n_full": INT, "full": INDICES, "n_diagonals": INT, "straight": INDICES, "scale": FLOATS,
    "n_pairs": INT, "pair": INDICES, "n_singles": INT, "single": INDICES,
    "n_forming": INT, "forming": INDICES, "n_products": INT, "product": INDICES,
    "n_nodes": INT, "node": INDICES, "n_panels": INT, "blocks": FLOATS, "update": INDICES, "right": INDICES,
    "place": INTS, "n_pivots": INT, "pivot": FLOATS, "diagonal": FLOATS, "n_x": INT, "x": FLOATS, "y": FLOATS,
})  # fmt: skip
"""The same by dense blocks (`stiffmbs.solve.linear.joint_blocks`).  Velocities are taken by threes.  Rows of `full`, where
each has an entry of J in all rows of a joint: how many these are, start and stride of the joint's panel, place in x, block of J for
the three, the first of them, and where the entries of each row begin among the values.  Rows of `straight`, where each has one entry, on
a diagonal: place and step in the panel, place in x, place and step in J, first velocity, three sources.  All others are copied into J
one by one.  Rows of `pair`: a joint's place in x, its block of J for three velocities of a body, the
first of them, the block's width.  Where each has one entry of J at the most, rows of `single`: place in x, entry, velocity.  Rows of
`forming`: a shape, where lines are added, their stride, and both factors with theirs; of `product`: where the product of two single
entries is added, and both.  Rows of `node`: size, width, start and stride of the node's panel, start and width of what stands right
of its block after the elimination, divided by the pivots, place in x, first pivot, end of its rows in `update` (a shape, where lines
are taken from, their stride, both factors), end in `right`, which holds the places in x of what stands right of blocks."""
