"""How arrays reach compiled code: a table of addresses with one named column for each array.

A layout lists names and types once; `packed` makes the table on the Python side, and native code reads it through
a view with the same names (`stiffmbs.compile.machine.native.access`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

Layout = Mapping[str, str]

INTS, INDICES, FLOATS, INT = "ints", "indices", "floats", "int"
DTYPES = {INTS: np.int64, INDICES: np.int32, FLOATS: np.float64}
"""Of the arrays; indices are short where long lists of them are read anew with each evaluation."""
OWN_INTS, OWN_INDICES, OWN_FLOATS = "own ints", "own indices", "own floats"
POINTERS = {INTS: INTS, INDICES: INDICES, FLOATS: FLOATS, OWN_INTS: INTS, OWN_INDICES: INDICES, OWN_FLOATS: FLOATS}
"""Kinds of arrays in compiled code.  Compiled code itself asks for the memory of those of its own, as their size is known
only on the way (`stiffmbs.compile.machine.native.memory`)."""

STATE: Layout = {
    "n_q": INT, "n_pose": INT, "n_u": INT, "n_c": INT, "spatial": INT,
    "q": FLOATS, "turn": FLOATS, "u": FLOATS, "a": FLOATS, "lam": FLOATS, "mu": FLOATS, "n_turned": INTS, "turned": INTS,
    "n_calls": INTS, "calls": INTS, "values": INTS, "n_joints": INT, "joint_start": INTS, "left_open": FLOATS,
}  # fmt: skip
"""A system's state and kernels: the number of coordinates, and of those of bodies, which come first; whether its bodies are spatial; q, u and accelerations a with the ground's at their end;
what kernels share of each body's orientation (`stiffmbs.compile.bodies`); for each term set the bodies (their first
coordinate) for which that is read, the number of its kernel calls, the address of their arguments (rows of `CALL`) and
the address of its values; the first row of each joint; what each equation may be off by."""

CALL = ("kernel", "count", "index", "number", "place")
"""The arguments of one kernel call, as 64-bit numbers."""

EQUATIONS: Layout = {
    "n": INT, "residual_set": INT, "matrix_set": INT, "n_plain": INT, "n_with_y": INT, "n_with_yp": INT,
    "r_row": INDICES, "r_source": INDICES, "r_operand": INDICES, "r_factor": FLOATS,
    "n_slots": INT, "n_entries": INT, "m_slot": INDICES, "m_source": INDICES, "m_constant": FLOATS, "m_cj": FLOATS,
    "n_moving_q": INT, "moving_q": INTS, "q_from": INTS, "offset": FLOATS, "q_ratio": FLOATS,
    "n_moving_u": INT, "moving_u": INTS, "u_from": INTS, "u_ratio": FLOATS,
    "at_mu": INTS, "at_lam": INTS, "integrated": INT, "has_mu": INT, "has_lam": INT,
}  # fmt: skip
"""Residual and matrix of one formulation (`stiffmbs.compile.equations`)."""

FACTORS: Layout = {
    "n": INT, "room": INT, "capacity": INT, "ready": INTS, "a_start": INTS, "a_row": INTS, "a": FLOATS, "scale": FLOATS,
    "order": INTS, "l_start": INTS, "l_row": OWN_INTS, "l": OWN_FLOATS, "u_start": INTS, "u_row": OWN_INTS, "u": OWN_FLOATS,
    "pivot": INTS, "work": FLOATS, "b": FLOATS, "previous": FLOATS, "stack": INTS, "x": FLOATS,
}  # fmt: skip
"""A sparse matrix by columns, its factors and work space (`stiffmbs.compile.machine.native.factors`).  `room` is the number of
entries that each factor is expected to have at the most, `capacity` the number for which there is memory."""

FIXED_ORDER: Layout = {
    "n": INT, "pivots": INT, "last_flag": INT, "array_of": INT, "factors": INTS, "found": INTS, "slot": INDICES, "weight": FLOATS,
    "lu": OWN_FLOATS, "row": OWN_INDICES, "column": OWN_INDICES, "update_start": INTS, "update": OWN_INDICES, "mark": INTS, "x": FLOATS,
}  # fmt: skip
"""A linear solver of IDA's along fixed pivots (`stiffmbs.solve.native.fixed_order`); it begins as the content of the
solver of SUNDIALS whose place it takes: number of unknowns, pivots, last flag.  Its long lists are of 32-bit numbers: a long
chain's solutions wait for memory."""

PAIRED_COLUMNS: Layout = {
    "n": INT, "pivots": INT, "last_flag": INT, "array_of": INT, "factors": INTS, "found": INTS, "slot": INDICES, "weight": FLOATS,
    "lu": OWN_FLOATS, "row": OWN_INDICES, "column": OWN_INDICES, "place": OWN_INDICES, "update_start": INTS, "update": OWN_INDICES,
    "item_start": INTS, "item_end": INTS, "side": INTS, "mark": INTS, "x": FLOATS,
}  # fmt: skip
"""The same with its columns in pairs (`stiffmbs.solve.native.paired_columns`)."""

DYNAMICS: Layout = {
    "state": INTS, "positions": INTS, "position_factors": INTS, "velocities": INTS, "velocity_factors": INTS,
    "accelerations": INTS, "acceleration_factors": INTS, "status": INTS,
    "n_behind": INT, "behind_source": INTS, "behind_row": INTS,
}  # fmt: skip
"""The tables of one state and its three block systems; `status` receives why no more instants could be reported;
`behind` tells where the rates of counters of turns and states stand among the terms of accelerations."""


IDA: Layout = {
    "state": INTS, "equations": INTS, "history": FLOATS, "array_header": INT,
    "n_event_functions": INT, "sides": FLOATS, "waits": INTS,
}  # fmt: skip
"""What IDA's callbacks work on; `array_header` is the size of the header before the data pointer of a numpy array."""


ELIMINATED: Layout = {
    "state": INTS, "n": INT, "n_u": INT, "n_f": INT, "n_gamma": INT, "n_j": INT, "n_slots": INT, "ready": INTS,
    "f_source": INDICES, "f_row": INDICES, "gamma_source": INDICES, "gamma_row": INDICES,
    "j_source": INDICES, "j_row": INDICES, "j_column": INDICES, "at_lam": INTS,
    "product_end": INDICES, "product_first": INDICES, "product_second": INDICES,
    "column_start": INDICES, "row": INDICES, "update_slot": INDICES,
    "scale": FLOATS, "j_scale": FLOATS, "j": FLOATS,
    "s": FLOATS, "l": FLOATS, "diagonal": FLOATS, "a": FLOATS, "b": FLOATS, "kept": FLOATS, "most_kept": FLOATS,
}  # fmt: skip
"""J M^-1 J^T and its factors by flat lists (`stiffmbs.solve.linear.eliminated`)."""


SCHEME: Layout = {
    "stages": INT, "extended": INT, "n_errors": INT, "n_dense": INT, "error_needs_end": INT,
    "c": FLOATS, "a": FLOATS, "errors": FLOATS, "dense": FLOATS,
    "exponent": FLOATS, "memory": FLOATS, "stability": FLOATS,
}  # fmt: skip
"""The coefficients of a Runge-Kutta scheme (`stiffmbs.solve.explicit.scheme`), one column for each stage."""

STEP_BOUND: Layout = {"n": INT, "place": INTS, "starts": FLOATS, "longest": FLOATS}
"""The longest steps that see what the inputs do (`stiffmbs.solve.events.step_bound`); n is 0 where nothing bounds a step."""

EXPLICIT: Layout = {
    "dynamics": INTS, "eliminated": INTS, "eliminates": INT, "pivots_tell": INT, "scheme": INTS, "n": INT, "n_q": INT, "project": INT,
    "tolerance": FLOATS, "rtol": FLOATS, "atol": FLOATS, "longest": FLOATS, "shortest": FLOATS, "step_bound": INTS,
    "t": FLOATS, "t_before": FLOATS, "span": FLOATS, "h": FLOATS, "last_error": FLOATS,
    "n_event_functions": INT, "n_events": INT, "sides": FLOATS, "at_event": INTS, "uncertain": INTS, "watch": INTS,
    "y": FLOATS, "y_before": FLOATS, "y_stage": FLOATS, "k": FLOATS, "difference": FLOATS, "polynomial": FLOATS,
    "dense_ready": INTS, "steps": INTS, "rejected": INTS, "accelerations": INTS, "stiff_steps": INTS,
    "n_times": INT, "times": FLOATS, "next_time": INTS,
    "room": INT, "rows": INTS, "row_t": FLOATS, "row_y": FLOATS, "ends": FLOATS,
}  # fmt: skip
"""An explicit integration between two calls: the state y = (q, u) now and before the last step (of length `span`), the
event functions' values there, the stages k, the counters, the output times (none: every step), and room for the rows and ends
of steps that one call stores."""

NATIVE_IDA: Layout = {
    "state": INTS, "equations": INTS, "array_of": INT, "matrix": INT, "pattern": INTS,
    "n_event_functions": INT, "sides": FLOATS, "waits": INTS,
    "memory": INT, "y": INT, "yp": INT, "at_output": INT, "output": FLOATS, "n_reported": INT, "reported": INTS,
    "solve": INT, "interpolate": INT, "time_of": INT, "order_of": INT, "step_of": INT,
    "stop_at": INT, "next_step_of": INT, "step_bound": INTS,
    "mark": FLOATS, "count": INTS, "history": FLOATS, "samples": FLOATS, "balance_mark": FLOATS, "balance": INTS,
    "iteration": INTS, "watch": INTS, "probe": FLOATS,
}  # fmt: skip
"""What the callbacks and the loop of the native IDA work on (`stiffmbs.solve.native.ida_loop`): functions and objects
of SUNDIALS by their addresses, the values of the matrix, how its pattern is written, and what is reported."""

BALANCE: Layout = {
    "mark": FLOATS, "memory": INT, "interpolate": INT, "weights": INT, "clear": INT, "setup": INT, "solve": INT,
    "solver": INT, "matrix": INT, "entries": INT, "pattern": INTS,
    "at_y": INT, "y": FLOATS, "at_yp": INT, "yp": FLOATS, "at_defect": INT, "defect": FLOATS,
    "at_correction": INT, "correction": FLOATS, "at_weight": INT, "weight": FLOATS,
}  # fmt: skip
"""Newton's iteration on an interpolated state (`stiffmbs.solve.native.output_correction`): functions, linear solver, and vectors."""

ITERATION: Layout = {
    "n": INT, "mark": FLOATS, "count": INTS, "memory": INT, "array_of": INT, "cj_of": INT, "iteration_of": INT,
}  # fmt: skip
"""What the convergence test of Newton's iteration in a step works on (`stiffmbs.solve.native.iteration`)."""

ERROR_NORM: Layout = {
    "memory": INT, "norm": INT, "array_of": INT, "steps_of": INT, "failures_of": INT, "order_of": INT, "mark": FLOATS, "count": INTS, "iteration": FLOATS, "state": INTS, "equations": INTS, "solve": INT,
    "solver": INT, "matrix": INT, "at_change": INT, "change": FLOATS, "at_filtered": INT, "filtered": FLOATS,
}  # fmt: skip
"""What the norm of IDA's error estimates works on (`stiffmbs.solve.native.error_norm`)."""


EVENT_SEARCH: Layout = {
    "n": INT, "n_event_functions": INT, "waits": INTS, "first_edge": INTS, "edges": FLOATS, "period": FLOATS,
    "value_before": FLOATS, "rate_before": FLOATS, "value_after": FLOATS, "rate_after": FLOATS,
    "a": FLOATS, "a_rate": FLOATS, "b": FLOATS, "b_rate": FLOATS, "m": FLOATS, "m2": FLOATS, "left_low": FLOATS, "left_high": FLOATS, "found": INTS,
    "n_state": INT, "n_nodes": INT, "node": FLOATS, "weight": FLOATS, "row": FLOATS, "n_angles": INT, "angle": INTS, "mark": FLOATS,
}  # fmt: skip
"""What the search for events within a step works on (`stiffmbs.solve.native.within_step`): the event functions with their
edges, their values and rates at both ends of the step and of a part of it, and states of the step at some nodes."""


def packed(layout: Layout, values: Mapping[str, Any]) -> np.ndarray:
    """The table for a layout: addresses of arrays, and numbers as they are.

    The arrays must be contiguous, of the layout's type, and live as long as the table is used.  Arrays of compiled
    code's own are empty at first (`stiffmbs.compile.machine.own_memory`).
    """
    table = np.zeros(len(layout), dtype=np.int64)
    for column, (name, kind) in enumerate(layout.items()):
        if kind not in (INT, *DTYPES):
            continue
        value = values[name]
        if kind == INT:
            table[column] = int(value)
        else:
            assert isinstance(value, np.ndarray) and value.flags.c_contiguous, name
            assert value.dtype == DTYPES[kind], name
            table[column] = value.__array_interface__["data"][0]
    return table
