"""Memory layout of accumulated errors."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

ACCUMULATED_ERRORS = Layout({
    "n": INT, "place": INTS, "mass": FLOATS, "displaced": FLOATS, "furthest": FLOATS,
    "n_damped": INT, "damped_source": INTS, "damped_row": INTS, "damped_column": INTS, "damped_factor": FLOATS,
    "each": FLOAT_CELL, "damping": FLOAT_CELL, "speed_error": FLOAT_CELL, "path": FLOAT_CELL, "time": FLOAT_CELL, "since": INT_CELL, "span": FLOAT_CELL,
})  # fmt: skip
"""Accumulated local errors of velocities (`stiffmbs.solve.error_control.native.accumulated_errors`): positions of the velocities
among the unknowns, their masses, displacements of positions, and the largest ones so far; entries of the derivatives of
forces by velocities.  Cells: change of the speed by the last error, damping rate, 1/s, error of the speed,
mass-weighted path and its time, s; steps since the last displacement, and their length, s."""
