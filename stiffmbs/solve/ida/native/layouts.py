"""Memory layouts of IDA's callbacks, loop, starts and norms.

Letters of these tables in native functions: docs/project/notation.md.
"""

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

NATIVE_IDA = Layout({
    "state": INTS, "equations": INTS, "array_of": INT, "matrix": INT,
    "memory": INT, "y": INT, "yp": INT, "at_output": INT, "output": FLOATS, "n_reported": INT, "reported": INTS,
    "solve": INT, "interpolate": INT, "time_of": INT, "order_of": INT, "step_of": INT,
    "stop_at": INT, "next_step_of": INT, "repeat": INT, "resolves": INT, "step_bound": INTS,
    "returned": FLOAT_CELL, "internal": FLOAT_CELL, "size": FLOAT_CELL, "next_size": FLOAT_CELL, "order": INT_CELL,
    "stopping": FLOAT_CELL, "served": INT_CELL, "tiny": INT_CELL,
    "recorded": INT_CELL, "history": FLOATS, "since_sample": INT_CELL, "next_sample": INT_CELL, "samples": FLOATS,
    "output_correction": INTS, "iteration": INTS, "watch": INTS, "look_at_start": INT, "look_within": INT, "probe": FLOATS, "residual": FLOATS, "atol": FLOATS, "rtol": FLOAT_CELL,
    "whole_steps": INTS, "error_norm": INTS, "closing": INTS, "starts": INT_CELL,
    "attempted": FLOAT_CELL, "trace": INT_CELL, "traced": INT_CELL, "n_places": INT_CELL, "places": INT_CELL,
})  # fmt: skip
"""Memory of the callbacks and the loop of the native IDA (`stiffmbs.solve.ida.native.ida_loop`): addresses of SUNDIALS
functions and objects, values of the matrix, and reported unknowns; function by which a one-step method
repeats its last step with another length, 0 for a multistep method; function that tells whether the error estimate of the
step holds over jumps; absolute and relative tolerances; correction of the states that are stored after steps, apart from that of
outputs, whose factors it would change.

Cells: times of the returned state and of IDA's internal state; size (0 before the first) and order of its last step,
size of the next attempt; address of the data of starts, 0 for none; last stop time; time at the end of the attempted step; output times served, tiny steps in succession; steps in the history,
steps since the last sample, position of the next one.  Address of rows for time, order, y and y' of each step (0 for none), and rows written in
this call.  Places within a step that have a row too."""

STEP = "end", "order", "size"
"""Numbers in a row of the history: time of the end, s, order, and size of a step, s."""
STEP_WIDTH = len(STEP)


START = Layout({
    "dynamics": INTS, "ida": INT, "error_norm": INTS, "n_watched": INT, "rate": FLOATS, "kept": FLOATS, "leader": INTS,
    "n_q": INT, "q_of": INTS, "q_at": INTS, "n_u": INT, "u_of": INTS, "u_at": INTS,
    "relaxations": FLOATS, "n_position_entries": INT, "position_source": INTS, "position_row": INTS, "position_drift": FLOAT_CELL,
    "n_velocity_entries": INT, "velocity_source": INTS, "velocity_row": INTS, "inverse_mass": FLOATS, "velocity_drift": FLOAT_CELL,
    "n_sets": INT, "at_relaxations": INTS, "sums": FLOATS,
    "n_f_q": INT, "f_q_source": INTS, "f_q_row": INTS, "f_q_scale": FLOATS, "n_f_u": INT, "f_u_source": INTS, "f_u_row": INTS, "f_u_scale": FLOATS,
    "soft": FLOAT_CELL, "loosest": FLOAT_CELL, "tightest": FLOAT_CELL, "growth": FLOAT_CELL,
    "of_positions": FLOAT_CELL, "of_velocities": FLOAT_CELL, "newton": FLOAT_CELL,
    "n_counters": INT, "counter": INTS, "counted": INTS, "count": INTS, "counts": INTS,
    "set_newton": INT, "reinitialise": INT, "set_first_step": INT, "set_growth": INT, "set_highest_order": INT,
    "n_event_functions": INT, "first_limit": INT, "n_counters_of_angles": INT, "angle_source": INTS, "angle_row": INTS,
    "reach": FLOAT_CELL, "along_q": FLOATS, "along_u": FLOATS, "q": FLOATS, "u": FLOATS, "values": FLOATS, "found": INTS,
    "t": FLOAT_CELL, "jumps": INT_CELL, "meets": INT_CELL,
    "amplified": FLOAT_CELL, "least": FLOAT_CELL, "balanced": FLOAT_CELL, "largest_jump": FLOAT_CELL, "least_jump": FLOAT_CELL, "speed": FLOATS, "gap": FLOAT_CELL, "passed": INT_CELL, "steps_before": INT_CELL,
})  # fmt: skip
"""Data of IDA's compiled starts (`stiffmbs.solve.ida.native.start`): memory for rates of coordinates, and for a state; independent coordinates and velocities, and their
positions among the unknowns; entries for the relaxations and the Newton tolerance; positions of relaxations in each
term set; counter functions, their arguments, space for one number, and their sums; functions of SUNDIALS.  A start changes only
both bounds of the stiffness, and the part of the tolerance that Newton's iteration may leave.

For restarts (`stiffmbs.solve.ida.native.breakpoints`): event functions, the first
of those that are limits of forces; revolution counters and their angles; a move to both sides of a state; memory for a
state and event functions.  Cells: size of the move; time of the restart, 1 if velocities have jumped, 1 if event functions
of velocities change sign between both sides.  For breakpoints passed in one call:
factor of long steps, least residual and allowed imbalance within them; largest velocity change without
a report, relative to the velocities, and the least one in m/s, with factors from velocities to m/s; time from a stop to the
restart after it; number of breakpoints passed, and steps before the last."""

OUTPUT_CORRECTION = Layout({
    "factored": FLOAT_CELL, "current": FLOAT_CELL, "enough": FLOAT_CELL, "long": FLOAT_CELL, "failed": INT_CELL, "first_failed": FLOAT_CELL,
    "balanced": FLOAT_CELL, "renewed": INT_CELL, "step": FLOAT_CELL, "force_end": INTS, "force_row": INTS,
    "n_joint_rows": INT, "joint_row": INTS, "dynamics": INTS, "pose": FLOATS,
    "predicts": INT_CELL, "predict": INT, "predict_rate": INT, "at_zero": INT,
    "memory": INT, "interpolate": INT, "weights": INT, "setup": INT, "solve": INT,
    "solver": INT, "matrix": INT, "entries": INT,
    "at_y": INT, "y": FLOATS, "at_yp": INT, "yp": FLOATS, "at_defect": INT, "defect": FLOATS,
    "at_correction": INT, "correction": FLOATS, "at_weight": INT, "weight": FLOATS, "size": FLOATS,
})  # fmt: skip
"""Newton's iteration on interpolated states (`stiffmbs.solve.ida.native.output_correction`).

Cells: cj of the factors (0 for none), cj of IDA, part of the tolerance that may remain, step, s, above which states
within it are corrected; number of states that could not be corrected, time of the first, s; allowed imbalance relative to the largest force; 1 if the matrix
of the iteration is newer than the stiffness; length of the step, s.  Then rows of the equations of motion, forces
before moments, and their ends; rows of position constraints; system that closes joints; memory for a pose; 1 to correct
the prediction of the current step; zeros."""

ITERATION = Layout({
    "n": INT, "has_kinks": INT, "memory": INT, "array_of": INT, "cj_of": INT, "iteration_of": INT,
    "cj": FLOAT_CELL, "matrix_cj": FLOAT_CELL, "first": FLOAT_CELL, "by_cj": FLOAT_CELL, "growth": FLOAT_CELL, "span": FLOAT_CELL,
    "done": INT_CELL, "age": INT_CELL, "since": INT_CELL, "slow": INT_CELL, "given_up": INT_CELL,
    "output_correction": INTS, "state": INTS, "equations": INTS, "time_of": INT, "t": FLOAT_CELL,
})  # fmt: skip
"""Convergence test of Newton's iteration in a step (`stiffmbs.solve.ida.native.iteration`).

Cells: cj, cj of the matrix, size of the first correction, part of the rate by the change of cj, growth of the remaining
rate (negative if unknown); age of the matrix as the sum of 1/cj, proportional to time within a factor of 2.3;
corrections before this one, steps since the matrix was computed, steps since a rate was measured; 1 to replace the
matrix, 1 after a failed iteration."""

ERROR_NORM = Layout({
    "memory": INT, "norm": INT, "array_of": INT, "steps_of": INT, "failures_of": INT, "order_of": INT,
    "trouble": FLOAT_CELL, "always": INT_CELL, "looked": FLOAT_CELL, "steps": INT_CELL, "failures": INT_CELL,
    "known_steps": INT_CELL, "known_failures": INT_CELL, "until": INT_CELL, "order": INT_CELL, "repeats": FLOAT_CELL,
    "equal_until": INT_CELL, "growth": FLOAT_CELL, "set_growth": INT,
    "iteration": INTS, "state": INTS, "equations": INTS, "solve": INT, "solver": INT, "matrix": INT, "at_change": INT, "change": FLOATS, "at_filtered": INT, "filtered": FLOATS,
    "ida": INT, "part_before_event": INT, "time_of": INT, "set_largest_part": INT, "set_least_part": INT, "t": FLOAT_CELL, "attempted": FLOAT_CELL, "begun": FLOAT_CELL, "enlarged": FLOAT_CELL, "repeated": INT_CELL,
})  # fmt: skip
"""Norm of IDA's error estimates (`stiffmbs.solve.ida.native.error_norm`).

Cells: failures of the error test with a weight that decreases with each step; 1 to filter all estimates; cj at the last
check of failures; steps and failures of the error test, and the same at the last check; step up to which estimates are
filtered; order of the last step; number of periods of a law whose features are resolved, else 1; step up to which steps
may not grow (0 for none), and least growth factor afterwards; current time. Cells of the last attempted step: time at
its end and at its start, factor of its norms, number of its repetitions up to an event."""
