"""Tables of variational equations.

Letters of these tables in native functions: docs/project/notation.md.
"""

from typing import Final

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INDICES, INT, INT_CELL, INTS, Layout

VARIATIONS = Layout({
    "state": INTS, "equations": INTS, "n": INT, "n_directions": INT, "n_slots": INT,
    "row": INDICES, "column": INDICES, "constant": FLOATS, "rate": FLOATS,
    "n_share": INT, "share": INTS, "parts": INTS, "by_time": INTS, "shift": FLOATS, "shifted": INT_CELL, "of_time": FLOATS,
    "setup": INT, "solve": INT, "solver": INT, "matrix": INT, "entries": INT,
    "at_defect": INT, "defect": FLOATS, "at_correction": INT, "correction": FLOATS, "s": FLOATS, "rates": FLOATS,
    "history": FLOATS, "times": FLOATS, "weight": FLOATS, "slope": FLOATS, "newest": INT_CELL, "cj": FLOAT_CELL,
})  # fmt: skip
"""Variational equations along a run (`stiffmbs.sensitivity_equations.native.variations`): rows and columns of the matrix' slots,
and their parts by y and by y'; addresses of the tables of `PART`; linear solver and
vectors; s and s' of a direction; the last `DEPTH` values of s of all directions with their times, and the coefficients
of a step. `by_time` is the `PART` of r_t, `shift` the derivative of the event time in each direction.

Cells: 1 if any shift is nonzero, newest row of the history, cj of the step."""

DEPTH: Final = 8
"""Number of stored steps; order 5 needs six before the current one."""

PART = Layout({
    "direction": INTS, "n_plain": INT, "n_with_y": INT, "n_with_yp": INT,
    "row": INDICES, "source": INDICES, "operand": INDICES, "factor": FLOATS,
})  # fmt: skip
"""Derivative dr/dp of one direction: its `DIRECTION`, and lines as those of a residual."""
