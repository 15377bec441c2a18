"""Memory layout of accumulated errors."""

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

ACCUMULATED_ERRORS = Layout({
    "n_groups": INT, "first": INTS, "place": INTS, "mass": FLOATS, "displaced": FLOATS, "furthest": FLOATS,
    "first_damped": INTS, "damped_source": INTS, "damped_row": INTS, "damped_column": INTS, "damped_factor": FLOATS,
    "each": FLOATS, "damping": FLOATS, "speed_error": FLOATS, "path": FLOATS, "time": FLOAT_CELL, "since": INT_CELL, "span": FLOAT_CELL,
})  # fmt: skip
"""Accumulated local errors of velocities (`stiffmbs.solve.error_control.native.accumulated_errors`): first velocity of each
group; positions of the velocities among the unknowns, their masses, displacements of positions, and the largest ones so
far; entries of the derivatives of forces by velocities, and the first one in the rows of each group.  For each group: change of the speed
by the last error, damping rate, 1/s, error of the speed, and mass-weighted path.  Cells: time of the paths, s; steps since
the last displacement, and their length, s."""
