"""What compiled code knows of a system: its state and kernels, the equations of a formulation, and the factors of a matrix."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import FLOATS, INDICES, INT, INT_CELL, INTS, OWN_FLOATS, OWN_INTS, Layout

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
    "n_slots": INT, "n_cleared": INT, "n_bare": INT, "m_bare": INDICES, "n_first": INT, "n_constant": INT, "n_entries": INT,
    "m_slot": INDICES, "m_source": INDICES, "m_constant": FLOATS, "m_cj": FLOATS,
    "n_moving_q": INT, "moving_q": INTS, "q_from": INTS, "offset": FLOATS, "q_ratio": FLOATS,
    "n_moving_u": INT, "moving_u": INTS, "u_from": INTS, "u_ratio": FLOATS,
    "at_mu": INTS, "at_lam": INTS, "at_x": INTS, "integrated": INT, "has_mu": INT, "has_lam": INT,
})  # fmt: skip
"""Residual and matrix of one formulation (`stiffmbs.compile.equations`), with the entries of
the matrix in the order of its `entry_lists`."""

FACTORS = Layout({
    "n": INT, "expected_entries": INT, "capacity": INT_CELL, "ready": INT_CELL, "a_start": INTS, "a_row": INTS, "a": FLOATS, "factored": FLOATS, "scale": FLOATS,
    "order": INTS, "l_start": INTS, "l_row": OWN_INTS, "l": OWN_FLOATS, "u_start": INTS, "u_row": OWN_INTS, "u": OWN_FLOATS,
    "pivot": INTS, "work": FLOATS, "b": FLOATS, "previous": FLOATS, "stack": INTS, "x": FLOATS,
})  # fmt: skip
"""A sparse matrix by columns, its factors and work space (`stiffmbs.compile.machine.native.factors`).  `expected_entries` is the number of
entries that each factor is expected to have at the most, `capacity` the number for which there is memory; `factored` holds the matrix
before it was scaled, where block systems keep it."""
