"""What Python and compiled code share: a table with one named column for each array, number or cell.

A layout lists names and types once; `packed` makes the table on the Python side, and native code reads it through
a view with the same names (`stiffmbs.compile.machine.native.access`).  A column holds the address of an array, a number
that stays, or a cell: a number that both sides read and set.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np


class Layout(dict[str, str]):
    """The columns of a table, each with its kind.

    Attributes
    ----------
    cells : dtype
        A table seen by it has its cells by name: ``table.view(layout.cells)[0]["steps"]`` is read and set in the table.
    """

    @cached_property
    def cells(self) -> np.dtype[np.void]:
        """The type of a row of a table by this layout, with its cells by name."""
        columns = {name: column for column, name in enumerate(self) if self[name] in CELLS}
        formats = ["f8" if self[name] == FLOAT_CELL else "i8" for name in columns]
        offsets = [8 * column for column in columns.values()]
        return np.dtype({"names": list(columns), "formats": formats, "offsets": offsets, "itemsize": 8 * len(self)})

    @cached_property
    def given(self) -> tuple[np.ndarray, tuple[str, ...], tuple[np.dtype[Any] | None, ...]]:
        """The columns whose values Python gives, numbers and addresses of arrays: their places, names, and types of the arrays."""
        found = {name: column for column, name in enumerate(self) if self[name] in (INT, *DTYPES)}
        types = (np.dtype(DTYPES[self[name]]) if self[name] in DTYPES else None for name in found)
        return np.array([*found.values()], dtype=np.intp), tuple(found), tuple(types)


INTS, INDICES, FLOATS, INT = "ints", "indices", "floats", "int"
FLOAT_CELL, INT_CELL = "float cell", "int cell"
CELLS = {FLOAT_CELL: "float", INT_CELL: "int"}
"""Kinds of cells in compiled code."""
DTYPES = {INTS: np.int64, INDICES: np.int32, FLOATS: np.float64}
"""Of the arrays; indices are short where long lists of them are read anew with each evaluation."""
OWN = OWN_INTS, OWN_INDICES, OWN_FLOATS = "own ints", "own indices", "own floats"
POINTERS = {INTS: INTS, INDICES: INDICES, FLOATS: FLOATS, OWN_INTS: INTS, OWN_INDICES: INDICES, OWN_FLOATS: FLOATS}
"""Kinds of arrays in compiled code.  Compiled code itself asks for the memory of those of its own, as their size is known
only on the way (`stiffmbs.compile.machine.native.memory`)."""

STATE = Layout({
    "n_q": INT, "n_pose": INT, "n_u": INT, "n_c": INT, "spatial": INT,
    "q": FLOATS, "turn": FLOATS, "u": FLOATS, "a": FLOATS, "lam": FLOATS, "mu": FLOATS, "n_turned": INTS, "turned": INTS,
    "n_calls": INTS, "calls": INTS, "values": INTS, "n_joints": INT, "joint_start": INTS, "left_open": FLOATS,
    "followed": FLOATS, "evaluated": INTS,
})  # fmt: skip
"""A system's state and kernels: the number of coordinates, and of those of bodies, which come first; whether its bodies are spatial; q, u and accelerations a with the ground's at their end;
what kernels share of each body's orientation (`stiffmbs.compile.bodies`); for each term set the bodies (their first
coordinate) for which that is read, the number of its kernel calls, the address of their arguments (rows of `CALL`) and
the address of its values; the first row of each joint; what each equation may be off by;
0 for each velocity that no coordinate follows, else 1; how often term sets were evaluated, one number."""

CALL = ("kernel", "count", "index", "number", "place")
"""The arguments of one kernel call, as 64-bit numbers."""

DIRECTION = Layout({
    "q": FLOATS, "turn": FLOATS, "u": FLOATS, "a": FLOATS, "lam": FLOATS, "mu": FLOATS,
    "n_turned": INT, "turned": INTS, "n_calls": INT, "calls": INTS, "values": FLOATS,
})  # fmt: skip
"""A direction in which the terms of one set change (`stiffmbs.compile.directional`): how the state changes, with the ground's
numbers at their ends; bodies whose orientation is shared, the arguments of the calls of kernels (rows of `CALL` and, last,
the address of how the elements' numbers change); the derivatives of the values."""

EQUATIONS = Layout({
    "n": INT, "residual_set": INT, "matrix_set": INT, "n_plain": INT, "n_with_y": INT, "n_with_yp": INT,
    "r_row": INDICES, "r_source": INDICES, "r_operand": INDICES, "r_factor": FLOATS,
    "n_slots": INT, "n_entries": INT, "m_slot": INDICES, "m_source": INDICES, "m_constant": FLOATS, "m_cj": FLOATS,
    "n_moving_q": INT, "moving_q": INTS, "q_from": INTS, "offset": FLOATS, "q_ratio": FLOATS,
    "n_moving_u": INT, "moving_u": INTS, "u_from": INTS, "u_ratio": FLOATS,
    "at_mu": INTS, "at_lam": INTS, "at_x": INTS, "integrated": INT, "has_mu": INT, "has_lam": INT,
})  # fmt: skip
"""Residual and matrix of one formulation (`stiffmbs.compile.equations`)."""

FACTORS = Layout({
    "n": INT, "expected_entries": INT, "capacity": INT_CELL, "ready": INT_CELL, "a_start": INTS, "a_row": INTS, "a": FLOATS, "factored": FLOATS, "scale": FLOATS,
    "order": INTS, "l_start": INTS, "l_row": OWN_INTS, "l": OWN_FLOATS, "u_start": INTS, "u_row": OWN_INTS, "u": OWN_FLOATS,
    "pivot": INTS, "work": FLOATS, "b": FLOATS, "previous": FLOATS, "stack": INTS, "x": FLOATS,
})  # fmt: skip
"""A sparse matrix by columns, its factors and work space (`stiffmbs.compile.machine.native.factors`).  `expected_entries` is the number of
entries that each factor is expected to have at the most, `capacity` the number for which there is memory; `factored` holds the matrix
before it was scaled, where block systems keep it."""

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
    "ready": INT_CELL, "pivoted": INT_CELL, "waits": INT_CELL, "serves": INT_CELL, "refused": INT_CELL, "refined": INT_CELL,
    "n_nodes": INT, "size": INTS, "start": INTS, "down_width": INTS, "right_width": INTS, "node_start": INTS, "place": INTS,
    "n_lu": INT, "lu": OWN_FLOATS, "slot": INDICES, "update_end": INTS, "update": INDICES,
    "down_at": INTS, "down_x": INTS, "right_at": INTS, "right_x": INTS, "x": FLOATS, "scratch": FLOATS,
    "kind": INTS, "n_diagonal": INT, "diagonal": INTS, "state": FLOATS, "pivot": FLOATS, "tried": FLOATS,
    "trial": FLOATS, "product": FLOATS, "terms": FLOATS, "allowed": FLOATS,
})  # fmt: skip
"""The same by dense blocks without pivots (`stiffmbs.solve.linear.native.block_lu`); `with_pivots` holds the address of the table
of columns in pairs that takes over where those cannot be trusted, `compile_pivots` that of the C function that puts the addresses of
its routines into the next two cells.  `ready` says whether the counts are of this run: whether the factors at
hand are those with pivots, how many more are, how many factorisations the last trial serves for yet, trials that were failed, and
whether solutions are refined."""

DYNAMICS = Layout({
    "state": INTS, "positions": INTS, "position_factors": INTS, "velocities": INTS, "velocity_factors": INTS,
    "accelerations": INTS, "acceleration_factors": INTS, "status": INT_CELL,
    "n_behind": INT, "behind_source": INTS, "behind_row": INTS, "by_reactions": INT,
    "n_algebraic": INT, "algebraic": INTS, "algebraic_scale": FLOATS, "algebraic_before": FLOATS,
    "n_turned_for_output": INT, "turned_for_output": INTS,
})  # fmt: skip
"""The tables of one state and its three block systems; `status` receives why no more instants could be reported;
`behind` tells where the rates of counters of turns and states stand among the terms of accelerations, and `by_reactions` whether any of them
depends on multipliers; then the coordinates that are algebraic states, sizes of them that matter, and their last values; and the
bodies whose orientation output terms ask for beside those that accelerations do, by their first coordinates."""


IDA = Layout({
    "state": INTS, "equations": INTS, "array_header": INT, "n_event_functions": INT, "signs": FLOATS, "masked": INTS,
    "last_time": FLOAT_CELL, "steps": INT_CELL, "rejected": INT_CELL, "n_ends": INT, "ends": FLOATS,
})  # fmt: skip
"""What IDA's callbacks work on; `array_header` is the size of the header before the data pointer of a numpy array.  They
note the last time asked for, count steps accepted and rejected, and keep the first ends of steps."""


ELIMINATED = Layout({
    "state": INTS, "n_u": INT, "trees": INT, "by_blocks": INT, "lists": INTS,
    "ready": INT_CELL, "kept": FLOAT_CELL, "most_kept": FLOAT_CELL,
    "n_f": INT, "f_source": INDICES, "f_row": INDICES, "scale": FLOATS, "a": FLOATS,
})  # fmt: skip
"""J M^-1 J^T (`stiffmbs.solve.linear.eliminated`): whether no joint closes a loop, whether it is factored by blocks, and the table of
these or of the entries; whether there are factors, what their pivots keep, and have kept at the most; forces, M^-1/2, accelerations."""

ENTRY_ELIMINATION = Layout({
    "n": INT, "n_gamma": INT, "n_j": INT, "n_slots": INT, "gamma_source": INDICES, "gamma_row": INDICES,
    "j_source": INDICES, "j_row": INDICES, "j_column": INDICES, "at_lam": INTS,
    "product_end": INDICES, "product_first": INDICES, "product_second": INDICES,
    "column_start": INDICES, "row": INDICES, "update_slot": INDICES,
    "j_scale": FLOATS, "j": FLOATS, "s": FLOATS, "l": FLOATS, "diagonal": FLOATS, "b": FLOATS,
})  # fmt: skip
"""The matrix and its factors by flat lists (`stiffmbs.solve.linear.matrix_entries`)."""

BLOCK_ELIMINATION = Layout({
    "n_gamma": INT, "gamma_source": INDICES, "gamma_place": INDICES,
    "n_first": INT, "n_j": INT, "j_source": INDICES, "j_at": INDICES, "j_scale": FLOATS, "j": FLOATS,
    "n_pairs": INT, "pair": INDICES, "n_singles": INT, "single": INDICES,
    "n_forming": INT, "forming": INDICES, "n_products": INT, "product": INDICES,
    "n_nodes": INT, "node": INDICES, "n_panels": INT, "blocks": FLOATS, "update": INDICES, "right": INDICES,
    "place": INTS, "pivot": FLOATS, "diagonal": FLOATS, "n_x": INT, "x": FLOATS, "y": FLOATS,
})  # fmt: skip
"""The same by dense blocks (`stiffmbs.solve.linear.joint_blocks`).  Velocities are taken by threes.  Rows of `pair`: a joint's place in x, its block of J for three velocities of a body, the
first of them, the block's width.  Where each has one entry of J at the most, rows of `single`: place in x, entry, velocity.  Rows of
`forming`: a shape, where lines are added, their stride, and both factors with theirs; of `product`: where the product of two single
entries is added, and both.  Rows of `node`: size, width, start and stride of the node's panel, start and width of what stands right
of its block after the elimination, divided by the pivots, place in x, first pivot, end of its rows in `update` (a shape, where lines
are taken from, their stride, both factors), end in `right`, which holds the places in x of what stands right of blocks."""


SCHEME = Layout({
    "stages": INT, "extended": INT, "n_errors": INT, "n_dense": INT, "error_needs_end": INT,
    "c": FLOATS, "a": FLOATS, "errors": FLOATS, "dense": FLOATS,
    "exponent": FLOAT_CELL, "memory": FLOAT_CELL, "stability": FLOAT_CELL,
})  # fmt: skip
"""The coefficients of a Runge-Kutta scheme (`stiffmbs.solve.explicit.scheme`), one column for each stage."""

STEP_BOUND = Layout({"n": INT, "place": INT_CELL, "starts": FLOATS, "longest": FLOATS})
"""The longest steps that see what the inputs do (`stiffmbs.solve.events.step_bound`); n is 0 where nothing bounds a step."""

LONG_STEPS = Layout({
    "n_nodes": INT, "node": FLOATS, "width": INT, "ratio": FLOAT_CELL, "remembered": FLOAT_CELL, "room": INT_CELL, "count": INT_CELL, "usual": FLOAT_CELL, "row": FLOATS,
})  # fmt: skip
"""Where steps far longer than those before are kept (`stiffmbs.solve.native.long_steps`): one row each of the step's two ends and its
states, of `width` numbers, at the nodes.  Cells: times the usual step beyond which a step is long, and of how many steps the usual one
is the mean; rows there is room for (0 where none is kept), rows kept, the usual step."""

EXPLICIT = Layout({
    "dynamics": INTS, "eliminated": INTS, "eliminates": INT_CELL, "pivots_tell": INT, "scheme": INTS, "n": INT, "n_q": INT, "project": INT,
    "tolerance": FLOAT_CELL, "rtol": FLOAT_CELL, "atol": FLOATS, "longest": FLOAT_CELL, "stable": FLOAT_CELL, "shortest": FLOAT_CELL, "step_bound": INTS,
    "t": FLOAT_CELL, "t_before": FLOAT_CELL, "span": FLOAT_CELL, "h": FLOAT_CELL, "last_error": FLOAT_CELL,
    "n_event_functions": INT, "end_at_event": INT, "signs": FLOATS, "at_event": INT_CELL, "uncertain": INT_CELL, "watch": INTS,
    "y": FLOATS, "y_before": FLOATS, "y_stage": FLOATS, "k": FLOATS, "difference": FLOATS, "weight": FLOATS, "polynomial": FLOATS,
    "dense_ready": INT_CELL, "steps": INT_CELL, "rejected": INT_CELL, "accelerations": INT_CELL, "stiff_steps": INT_CELL, "far_beyond": INT_CELL,
    "long_steps": INTS,
    "n_times": INT, "times": FLOATS, "next_time": INT_CELL,
    "capacity": INT, "rows": INT_CELL, "row_t": FLOATS, "row_y": FLOATS, "ends": FLOATS,
})  # fmt: skip
"""An explicit integration between two calls: the state y = (q, u) now and before the last step (of length `span`), the
event functions' values there, the stages k, one over the tolerance of each number in the last step tried, the counters, the
output times (none: every step), and memory for the rows and ends of steps that one call stores."""

NATIVE_IDA = Layout({
    "state": INTS, "equations": INTS, "array_of": INT, "matrix": INT, "pattern": INTS,
    "n_event_functions": INT, "signs": FLOATS, "masked": INTS,
    "memory": INT, "y": INT, "yp": INT, "at_output": INT, "output": FLOATS, "n_reported": INT, "reported": INTS,
    "solve": INT, "interpolate": INT, "time_of": INT, "order_of": INT, "step_of": INT,
    "stop_at": INT, "next_step_of": INT, "step_bound": INTS,
    "returned": FLOAT_CELL, "internal": FLOAT_CELL, "size": FLOAT_CELL, "next_size": FLOAT_CELL, "order": INT_CELL,
    "stopping": FLOAT_CELL, "served": INT_CELL, "tiny": INT_CELL, "within": INT_CELL,
    "recorded": INT_CELL, "history": FLOATS, "since_sample": INT_CELL, "next_sample": INT_CELL, "samples": FLOATS,
    "output_correction": INTS, "iteration": INTS, "watch": INTS, "look_at_start": INT, "look_within": INT, "probe": FLOATS,
    "long_steps": INTS,
    "trace": INT_CELL, "traced": INT_CELL, "seen": FLOAT_CELL,
})  # fmt: skip
"""What the callbacks and the loop of the native IDA work on (`stiffmbs.solve.native.ida_loop`): functions and objects
of SUNDIALS by their addresses, the values of the matrix, how its pattern is written, and what is reported.

Cells: the time of the returned state, the time that IDA has reached inside, size (0 before the first) and order of its
last step, size of the one that it will try next; where it was last told to stop; output points served, tiny steps in succession, whether the last event
was found by the search within the step; steps in the history, steps since the last sample, place of the next one; the address
of rows for time, order, y and y' of each step (0: none are kept), and rows written in this call; the time for which the state holds the values of event functions."""
MOST_STEPS, HISTORY_WIDTH = 2048, 3
"""Steps of any one call, and rows of the history: time of the end, order, size."""
SAMPLES = 16
"""Rows of the samples: the time and what is reported."""

RESTART = Layout({
    "dynamics": INTS, "ida": INT, "error_norm": INTS, "q": FLOATS, "u": FLOATS, "rate": FLOATS, "leader": INTS,
    "n_q": INT, "q_of": INTS, "q_at": INTS, "n_u": INT, "u_of": INTS, "u_at": INTS,
    "creep": FLOATS, "n_position_entries": INT, "position_source": INTS, "position_row": INTS, "position_creep": FLOAT_CELL,
    "n_velocity_entries": INT, "velocity_source": INTS, "velocity_row": INTS, "velocity_weight": FLOATS,
    "at_residual": INT, "at_matrix": INT, "mass": FLOATS, "sums": FLOATS,
    "n_f_q": INT, "f_q_source": INTS, "f_q_row": INTS, "n_f_u": INT, "f_u_source": INTS, "f_u_row": INTS,
    "soft": FLOAT_CELL, "loosest": FLOAT_CELL, "tightest": FLOAT_CELL, "growth": FLOAT_CELL,
    "set_newton": INT, "start_anew": INT, "set_first_step": INT, "set_growth": INT,
})  # fmt: skip
"""What IDA is started anew with behind a jump of inputs (`stiffmbs.solve.ida.native.restart`): the state from one call to the next;
independent coordinates and velocities, and where they stand among the unknowns; the entries that relaxations and the tolerance of
Newton's iteration follow from; functions of SUNDIALS.  Cells are set once."""

OUTPUT_CORRECTION = Layout({
    "factored": FLOAT_CELL, "current": FLOAT_CELL, "enough": FLOAT_CELL, "long": FLOAT_CELL,
    "made": FLOAT_CELL, "growth": FLOAT_CELL, "since": INT_CELL,
    "balanced": FLOAT_CELL, "unseen": INT_CELL, "next_look": INT_CELL, "force_end": INTS, "force_row": INTS,
    "memory": INT, "interpolate": INT, "weights": INT, "clear": INT, "setup": INT, "solve": INT,
    "solver": INT, "matrix": INT, "entries": INT, "pattern": INTS,
    "at_y": INT, "y": FLOATS, "at_yp": INT, "yp": FLOATS, "at_defect": INT, "defect": FLOATS,
    "at_correction": INT, "correction": FLOATS, "at_weight": INT, "weight": FLOATS, "size": FLOATS,
})  # fmt: skip
"""Newton's iteration on an interpolated state (`stiffmbs.solve.native.output_correction`): functions, linear solver, and vectors.

Cells: cj of the factors (0 where there are none), cj of IDA's, the part of the tolerance that may be left, the step, s,
beyond which states within it are corrected; the time at which the factors were made, what the rate of convergence
grows by in a second from there (below 0: not known), and states corrected since that was measured; the part of the largest
force that may be left, states that are not looked at after one that is balanced, and those of them that are to come.  The rows of the
equations of motion: those of forces, then those of moments, and where either end."""

VARIATIONS = Layout({
    "state": INTS, "equations": INTS, "n": INT, "n_directions": INT, "n_slots": INT,
    "row": INDICES, "column": INDICES, "place": INDICES, "constant": FLOATS, "rate": FLOATS,
    "n_share": INT, "share": INTS, "parts": INTS, "by_time": INTS, "shift": FLOATS, "shifted": INT_CELL, "of_time": FLOATS,
    "clear": INT, "setup": INT, "solve": INT, "solver": INT, "matrix": INT, "entries": INT, "pattern": INTS,
    "at_defect": INT, "defect": FLOATS, "at_correction": INT, "correction": FLOATS, "s": FLOATS, "rates": FLOATS,
    "history": FLOATS, "times": FLOATS, "weight": FLOATS, "slope": FLOATS, "newest": INT_CELL, "cj": FLOAT_CELL,
})  # fmt: skip
"""The variational equations along a run (`stiffmbs.solve.native.variations`): rows and columns of the matrix' slots, their place
in the linear solver, and their parts by y and by y'; addresses of the tables of `PART`; linear solver and vectors; a
direction's s and s'; the last `DEPTH` s of all directions with their times, and the coefficients of a step.

`by_time` is the `PART` of r_t, `shift` the time by which each direction's s is shifted.

Cells: whether any is, which row of the history is the last, and cj of the step."""
DEPTH = 8
"""Steps that are remembered; order 5 needs six before the present one."""

PART = Layout({
    "direction": INTS, "n_plain": INT, "n_with_y": INT, "n_with_yp": INT,
    "row": INDICES, "source": INDICES, "operand": INDICES, "factor": FLOATS,
})  # fmt: skip
"""dr/dp of one direction: its `DIRECTION`, and lines as those of a residual."""

ITERATION = Layout({
    "n": INT, "memory": INT, "array_of": INT, "cj_of": INT, "iteration_of": INT,
    "cj": FLOAT_CELL, "matrix_cj": FLOAT_CELL, "first": FLOAT_CELL, "by_cj": FLOAT_CELL, "growth": FLOAT_CELL, "span": FLOAT_CELL,
    "done": INT_CELL, "age": INT_CELL, "since": INT_CELL, "slow": INT_CELL,
})  # fmt: skip
"""What the convergence test of Newton's iteration in a step works on (`stiffmbs.solve.native.iteration`).

Cells: cj, that of the matrix, size of the first correction, the part of the rate by the change of cj, what the rest grows by
in a time (below 0: not known), and the time since the matrix was made, by the sum of 1/cj, which a step is but for a factor
of 1 to 2.3; corrections before this one, steps since the matrix was made, steps since a rate was measured, whether the
matrix is to be made anew."""

ERROR_NORM = Layout({
    "memory": INT, "norm": INT, "array_of": INT, "steps_of": INT, "failures_of": INT, "order_of": INT,
    "trouble": FLOAT_CELL, "always": INT_CELL, "looked": FLOAT_CELL, "steps": INT_CELL, "failures": INT_CELL,
    "known_steps": INT_CELL, "known_failures": INT_CELL, "until": INT_CELL, "order": INT_CELL,
    "equal_until": INT_CELL, "growth": FLOAT_CELL, "set_growth": INT,
    "iteration": INTS, "state": INTS, "equations": INTS, "solve": INT, "solver": INT, "matrix": INT, "at_change": INT, "change": FLOATS, "at_filtered": INT, "filtered": FLOATS,
})  # fmt: skip
"""What the norm of IDA's error estimates works on (`stiffmbs.solve.native.error_norm`).

Cells: failures of the error test, each counted less with each step since then; whether all estimates are filtered; cj when
failures were last looked for; steps and failures of the error test, the same when they were last looked at; the step up to
which estimates are filtered; the order of the last step; the step up to which steps may not grow (0: they may), and the factor by
which the test must let them grow else."""


EVENT_SEARCH = Layout({
    "n": INT, "n_event_functions": INT, "masked": INTS, "first_edge": INTS, "edges": FLOATS, "overlap": FLOATS, "period": FLOATS,
    "value_before": FLOATS, "rate_before": FLOATS, "value_after": FLOATS, "rate_after": FLOATS,
    "a": FLOATS, "a_rate": FLOATS, "b": FLOATS, "b_rate": FLOATS, "m": FLOATS, "m2": FLOATS, "left_low": FLOATS, "left_high": FLOATS, "noise": FLOATS, "found": INTS,
    "zone_low": FLOATS, "zone_high": FLOATS, "apart": FLOATS, "n_calls": INT, "call": INTS, "near": INTS,
    "n_state": INT, "n_nodes": INT, "node": FLOATS, "weight": FLOATS, "row": FLOATS, "n_angles": INT, "angle": INTS,
    "ready": INT_CELL, "begun": FLOAT_CELL, "depth": FLOAT_CELL,
})  # fmt: skip
"""What the search for events within a step works on (`stiffmbs.solve.native.event_search.within_step`): the event functions with their
edges, their values and rates at both ends of the step and of a part of it, the kernel that computes each and which kernels
have one near an edge, and states of the step at some nodes.

Cells: whether values at the start of the step are known, that start's time, and how far an event function must go beyond
zero."""


def packed(layout: Layout, values: Mapping[str, Any]) -> np.ndarray:
    """The table for a layout: addresses of arrays, numbers as they are, and cells, zero where no value is given.

    The arrays must be contiguous, of the layout's type, and live as long as the table is used.  Arrays of compiled
    code's own are empty at first (`stiffmbs.compile.machine.own_memory`).
    """
    table = np.zeros(len(layout), dtype=np.int64)
    fill(table, layout, values)
    return table


def arrays_of(layout: Layout, lists: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Lists of numbers, or of rows of them, as flat arrays of the layout's types."""
    return {name: np.asarray(values, dtype=DTYPES[layout[name]]).reshape(-1) for name, values in lists.items()}


def fill(table: np.ndarray, layout: Layout, values: Mapping[str, Any]) -> None:
    """Fill a table; cells for which no value is given keep theirs."""
    own = table.view(layout.cells)[0]
    for name in layout.cells.names or ():
        if name in values:
            own[name] = values[name]
    columns, names, types = layout.given
    numbers = []
    for name, dtype in zip(names, types, strict=True):
        value = values[name]
        if dtype is not None:
            assert isinstance(value, np.ndarray) and value.flags.c_contiguous, name
            assert value.dtype == dtype, name
            value = address(value)
        numbers.append(int(value))
    table[columns] = numbers


def address(array: np.ndarray) -> int:
    """The address of an array's numbers, in a tenth of the time that ``array.ctypes.data`` takes."""
    if array.size and array.flags.writeable:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]
    at: int = array.__array_interface__["data"][0]
    return at


def addresses(*arrays: np.ndarray) -> list[int]:
    """The addresses of several arrays' numbers."""
    return [address(array) for array in arrays]
