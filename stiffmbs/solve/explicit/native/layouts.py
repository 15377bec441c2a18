"""Memory layouts of a Runge-Kutta scheme and of explicit integration.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

SCHEME = Layout({
    "order": INT, "stages": INT, "extended": INT, "n_errors": INT, "n_dense": INT, "n_free": INT, "error_needs_end": INT, "by_stages": INT, "columns": INT,
    "c": FLOATS, "a": FLOATS, "errors": FLOATS, "dense": FLOATS, "free": FLOATS, "free_error": FLOATS,
    "exponent": FLOAT_CELL, "memory": FLOAT_CELL, "stability": FLOAT_CELL,
})  # fmt: skip
"""Coefficients of a Runge-Kutta scheme (`stiffmbs.solve.explicit.scheme`), one column for each stage."""

LINEARLY_IMPLICIT = Layout({
    "state": INTS, "equations": INTS, "columns": INT, "setup": INT, "solve": INT, "solver": INTS, "entries": FLOATS, "ready": INTS, "refused": INTS, "refined": INTS,
    "b": FLOATS, "x": FLOATS, "start": FLOATS, "whole": FLOATS, "unresolved": FLOAT_CELL,
})  # fmt: skip
"""Linearly implicit steps (`stiffmbs.solve.explicit.linearly_implicit`): equations and their linear solver, with its
cells `ready` (0 if no pivots are known), `refused` and `refined` (not 0 if its solutions depend on earlier factors); state at the start of a step, and after one step without extrapolation; time of the first step that does not resolve a growth, NaN if there is none."""

EXPLICIT = Layout({
    "dynamics": INTS, "eliminated": INTS, "eliminates": INT_CELL, "pivots_tell": INT, "scheme": INTS, "n": INT, "n_q": INT, "project": INT_CELL,
    "tolerance": FLOAT_CELL, "rtol": FLOAT_CELL, "atol": FLOATS, "longest": FLOAT_CELL, "stable": FLOAT_CELL, "shortest": FLOAT_CELL, "step_bound": INTS,
    "t": FLOAT_CELL, "t_before": FLOAT_CELL, "span": FLOAT_CELL, "h": FLOAT_CELL, "last_error": FLOAT_CELL,
    "at_event": INT_CELL, "uncertain": INT_CELL, "distance": FLOAT_CELL, "distance_of_end": FLOAT_CELL, "watch": INTS,
    "started": INT_CELL, "rates_known": INT_CELL, "lam": FLOATS, "y": FLOATS, "y_before": FLOATS, "y_first": FLOATS, "y_stage": FLOATS, "k": FLOATS, "difference": FLOATS, "weight": FLOATS, "polynomial": FLOATS,
    "dense_ready": INT_CELL, "steps": INT_CELL, "rejected": INT_CELL, "accelerations": INT_CELL, "stiff_steps": INT_CELL, "far_beyond": INT_CELL,
    "whole_steps": INTS, "repeats": FLOAT_CELL, "linear_step": INT, "linear": INTS,
    "n_times": INT_CELL, "times": FLOATS, "next_time": INT_CELL,
    "capacity": INT, "rows": INT_CELL, "row_t": FLOATS, "row_y": FLOATS, "ends": FLOATS,
})  # fmt: skip
"""Explicit integration between two calls: the state y = (q, u) now and before the last step of length `span`; its event
functions; the stages k; inverse tolerances of the last attempt; the number of polynomials of the last step (0 if not
computed); counters; output times (none for every step); memory for the rows and ends of steps in one call.  `started`
is 0 before a restart: the state, its accelerations in the last stage, and `lam` are then consistent.
Fixed steps return to `y_first` if they fail; `rates_known` is 1 if the last stage has the rates at their start.  `repeats` is the number of periods of laws that end a step in each."""
