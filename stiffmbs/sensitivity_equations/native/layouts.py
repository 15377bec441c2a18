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

STAGES = Layout({
    "state": INTS, "equations": INTS, "n": INT, "stages": INT, "n_slots": INT, "row": INDICES, "column": INDICES,
    "constant": FLOATS, "rate": FLOATS, "mean_constant": FLOATS, "mean_rate": FLOATS,
    "own": INDICES, "n_coupled": INT, "coupled": INDICES, "coupling": INDICES, "whole": INTS, "whole_entries": FLOATS,
    "re_re": INDICES, "im_im": INDICES, "im_re": INDICES, "re_im": INDICES, "setup": INT, "solve": INT, "solvers": INTS, "values": INTS, "h": FLOAT_CELL,
    "derivative": FLOATS, "transform": FLOATS, "inverse": FLOATS, "real": FLOATS, "imaginary": FLOATS, "weight": FLOATS,
    "residual": FLOATS, "apart": FLOATS, "pair": FLOATS, "solution": FLOATS, "correction": FLOATS, "slope": FLOATS, "sum": FLOATS,
})  # fmt: skip
"""Stages of variational equations (`stiffmbs.sensitivity_equations.native.stages`): rows and columns of the matrix' slots, their
parts by y and by y' at each point, and the means of these.

`own`, `coupling`: entries of the matrix of all stages for the slots in the blocks of one stage, and for the `coupled` ones, with y',
in all blocks; `whole` has its factors. `solvers`, `values`: addresses of the linear solvers of the real matrix and of the complex
ones, as pairs, for the step `h`, and of the values of these matrices; `real`, `imaginary`: eigenvalues of D. `weight` of the unknowns in the sizes of corrections."""
