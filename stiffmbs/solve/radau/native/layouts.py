"""Memory layouts of a Radau method and of its steps.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INDICES, INT, INT_CELL, INTS, Layout

COLLOCATION = Layout({
    "stages": INT, "pairs": INT, "nodes": FLOATS, "derivative": FLOATS, "transform": FLOATS, "inverse": FLOATS, "gamma": FLOAT_CELL, "relaxed": FLOAT_CELL, "alpha": FLOATS,
    "beta": FLOATS, "error": FLOATS, "weights": FLOATS, "bubble": FLOATS, "n_between": INT, "between": FLOATS, "most_between": FLOAT_CELL, "setup_cost": FLOAT_CELL, "iteration_cost": FLOAT_CELL, "keep": FLOAT_CELL,
})  # fmt: skip
"""Coefficients of `stiffmbs.solve.radau.collocation.Collocation`; `relaxed` is the tolerance of the error estimate
relative to the requested one. Costs of the matrices of a step and of an iteration, in any unit. Convergence rate below
which matrices are kept."""

RADAU = Layout({
    "state": INTS, "equations": INTS, "array_of": INT, "n": INT, "n_tested": INT_CELL, "n_closing": INT_CELL, "algebraic": FLOATS, "methods": INTS, "n_methods": INT, "below": INTS,
    "setup": INT, "solve": INT, "solver": INTS, "matrix": INTS, "values": INTS,
    "n_slots": INT, "re_re": INDICES, "im_im": INDICES, "n_imaginary": INT, "imaginary_of": INDICES, "im_re": INDICES, "re_im": INDICES,
    "n_terms": INT, "terms": FLOATS, "terms_aside": FLOATS, "entries": FLOATS, "n_all": INT, "n_efforts": INT, "acting": INT_CELL, "effort_source": INDICES,
    "n_levers": INT, "lever_source": INDICES, "lever_effort": INDICES, "lever_unknown": INDICES, "lever_factor": FLOATS, "lever": FLOATS,
    "n_slopes": INT, "slope_source": INDICES, "slope_effort": INDICES, "slope_unknown": INDICES, "slope_factor": FLOATS, "slope": FLOATS, "misfit": FLOATS, "at_b": INT, "b": FLOATS, "at_x": INT, "x": FLOATS, "at_pair_b": INT, "pair_b": FLOATS, "at_pair_x": INT, "pair_x": FLOATS,
    "output_correction": INTS, "error_norm": INTS, "step_bound": INTS, "n_angles": INT, "angle": INTS, "spin": INTS, "n_positions": INT, "position": INTS, "velocity": INTS, "prescribed": INTS,
    "y": FLOATS, "yp": FLOATS, "y_stage": FLOATS, "yp_stage": FLOATS, "z": FLOATS, "r": FLOATS, "d": FLOATS, "past": FLOATS, "y_past": FLOATS, "error": FLOATS, "weight": FLOATS,
    "atol": FLOATS, "rtol": FLOAT_CELL, "newton": FLOAT_CELL, "part": FLOAT_CELL, "longest": FLOAT_CELL, "first": FLOAT_CELL, "stop": FLOAT_CELL, "stops": INT_CELL,
    "t": FLOAT_CELL, "h": FLOAT_CELL, "h_past": FLOAT_CELL, "method": INT_CELL, "method_past": INT_CELL, "decaying": INT_CELL,
    "h_factored": FLOAT_CELL, "stages_factored": INT_CELL, "current": INT_CELL, "rate_kept": INT_CELL, "rejected": INT_CELL, "attempts": INT_CELL, "renewed": INT_CELL, "ahead": INT_CELL, "error_size": FLOAT_CELL, "damped": INT_CELL, "left": FLOAT_CELL, "suggested": FLOAT_CELL,
    "corrections": FLOATS, "apart": FLOAT_CELL, "n_corrections": INT_CELL, "suffice": INT_CELL,
    "contraction": FLOAT_CELL, "last_error": FLOAT_CELL, "h_accepted": FLOAT_CELL, "since_change": INT_CELL, "iterations_taken": INT_CELL,
    "has_kinks": INT,
    "steps": INT_CELL, "residuals": INT_CELL, "jacobians": INT_CELL, "factorizations": INT_CELL, "error_failures": INT_CELL,
    "step_failures": INT_CELL, "iterations": INT_CELL, "newton_failures": INT_CELL,
    "least_factor": FLOAT_CELL, "largest_factor": FLOAT_CELL, "keep_matrix": FLOAT_CELL, "keep_high": FLOAT_CELL,
    "stages_after": INT_CELL, "gain": FLOAT_CELL, "slowest": FLOAT_CELL, "converging": FLOAT_CELL, "after_failure": FLOAT_CELL, "remainder": FLOAT_CELL, "tolerance": FLOAT_CELL,
})  # fmt: skip
"""Memory of an integration by Radau methods.

Tables of state and equations; methods by number of stages, and below each the one of two stages less.  Linear solvers: functions of SUNDIALS; solver, matrix and
values of the real matrix and of each complex one, a real matrix of twice the size; slots of the pattern in both; terms of these matrices,
which other evaluations at the state do not change, and others aside.
Efforts of stiff forces, which follow the unknowns in all stages (`n_all` numbers): positions of
their values; the number of efforts that are unknowns in this step, all or none; their levers and slopes, and both as they were when the matrix was evaluated; misfit of the stored efforts
in each stage.  Vectors of a linear system, real and complex.  The state y and y' at t; stages and residuals; the polynomial of the last
step with its beginning; error estimate and inverse tolerances.

Unknowns that are angles of bodies in the plane, and their angular velocities. Unknowns that are positions, and their velocities or -1; 1 for those that joints and
drives prescribed in the last step.

Rows without rates have the value 1 in `algebraic`; `n_closing` of these belong to joints.

Cell `apart`: error of prescribed positions between the nodes of the last step, in tolerances.

Cells: tolerances, the requested relative one, part that Newton's iteration may leave; largest and first step, stop
time; time, next step, last step, methods of both; step size, method and time of the factors, 1 if the matrix belongs to
the beginning of the step, 1 to make it that of the predicted end.  Convergence rate of Newton's iteration, its last ratio, and what it left, in tolerances; error and size of the last
accepted step, 1 if that error is without damped motions; 1 before motions that decay within a first step are removed; steps since a change of the method.  Corrections between steps (`stiffmbs.solve.radau.native.between_steps`),
their number, and whether they suffice. 1 if laws have jumps or kinks.  Counters, then the parameters of
`stiffmbs.solve.radau.parameters`."""
