"""Layouts of the tables for compiled code: state and kernels, equations of a formulation, factors of a matrix.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import FLOATS, INDICES, INT, INT_CELL, INTS, OWN_FLOATS, OWN_INTS, Layout

STATE = Layout({
    "n_q": INT, "n_pose": INT, "n_u": INT, "n_c": INT, "spatial": INT,
    "q": FLOATS, "turn": FLOATS, "u": FLOATS, "a": FLOATS, "lam": FLOATS, "mu": FLOATS, "n_turned": INTS, "turned": INTS,
    "n_calls": INTS, "calls": INTS, "values": INTS, "n_joints": INT, "joint_start": INTS, "left_open": FLOATS,
    "followed": FLOATS, "evaluated": INTS,
})  # fmt: skip
"""State and kernels of a system: numbers of coordinates, body coordinates (first), velocities and equations; whether
bodies are spatial; q, u and accelerations a, with the ground's at their end; shared orientation values. For each term
set: bodies (first coordinates) whose shared values it reads, number of kernel calls, addresses of their arguments (rows
of `CALL`) and of its values. First row of each joint; tolerance of each equation; 0 for velocities that no coordinate
follows, else 1; number of evaluations."""

CALL = Layout({"kernel": INT, "count": INT, "index": INTS, "number": FLOATS, "place": INTS})
"""Arguments of one kernel call; `kernel` is the address of a compiled function."""

DIRECTION = Layout({
    "q": FLOATS, "turn": FLOATS, "u": FLOATS, "a": FLOATS, "lam": FLOATS, "mu": FLOATS,
    "n_turned": INT, "turned": INTS, "n_calls": INT, "calls": INTS, "values": FLOATS, "terms": FLOATS,
})  # fmt: skip
"""Direction of change of the terms of one set (`stiffmbs.compile.directional`): changes of the state, with the ground's
at their ends; bodies with shared orientation values; arguments of the kernel calls (rows of `CALL` and the address of
the changes of the elements' numbers); derivatives of the values, and the values."""

EQUATIONS = Layout({
    "n": INT, "residual_set": INT, "matrix_set": INT, "n_plain": INT, "n_with_y": INT, "n_with_yp": INT,
    "r_row": INDICES, "r_source": INDICES, "r_operand": INDICES, "r_factor": FLOATS,
    "n_slots": INT, "n_constant": INT, "n_entries": INT,
    "m_slot": INDICES, "m_source": INDICES, "m_constant": FLOATS, "m_cj": FLOATS,
    "n_straight": INT, "straight_slot": INDICES, "straight_source": INDICES, "straight_factor": FLOATS,
    "n_turned": INT, "turned_place": INDICES, "turned_source": INDICES, "turned_factor": FLOATS,
    "n_turns": INT, "turn_body": INDICES, "turn_slot": INDICES, "turn_row": FLOATS,
    "n_moving_q": INT, "moving_q": INTS, "q_from": INTS, "offset": FLOATS, "q_ratio": FLOATS,
    "n_moving_u": INT, "moving_u": INTS, "u_from": INTS, "u_ratio": FLOATS,
    "at_mu": INTS, "at_lam": INTS, "at_x": INTS, "integrated": INT, "has_mu": INT, "has_lam": INT,
})  # fmt: skip
"""Residual and matrix of one formulation (`stiffmbs.compile.equations`); matrix entries ordered by `entry_lists`.

Condensed entries are derivatives by positions of bodies. Those by quaternions are collected in `turn_row`, four for each row
and body, whose products with Z belong to three slots.
"""

FACTORS = Layout({
    "n": INT, "expected_entries": INT, "capacity": INT_CELL, "ready": INT_CELL, "a_start": INTS, "a_row": INTS, "a": FLOATS, "factored": FLOATS, "scale": FLOATS,
    "order": INTS, "l_start": INTS, "l_row": OWN_INTS, "l": OWN_FLOATS, "u_start": INTS, "u_row": OWN_INTS, "u": OWN_FLOATS,
    "pivot": INTS, "work": FLOATS, "b": FLOATS, "previous": FLOATS, "stack": INTS, "x": FLOATS,
})  # fmt: skip
"""Sparse matrix by columns, with factors and work space. `expected_entries` is the expected largest number of entries
of each factor, `capacity` the number of allocated entries; `factored` holds the unscaled matrix of block systems."""
