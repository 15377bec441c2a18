"""Tables of integrators: steps of IDA and explicit steps, and the search within them."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

IDA = Layout({
    "state": INTS, "equations": INTS, "array_header": INT, "n_event_functions": INT, "signs": FLOATS, "masked": INTS,
    "last_time": FLOAT_CELL, "steps": INT_CELL, "rejected": INT_CELL, "n_ends": INT, "ends": FLOATS,
})  # fmt: skip
"""Tables of scikit-sundae's callbacks.  `array_header` is the size of the header before the data pointer of a NumPy
array.  The callbacks note the last time, count accepted and rejected steps, and store the first ends of steps."""

SCHEME = Layout({
    "order": INT, "stages": INT, "extended": INT, "n_errors": INT, "n_dense": INT, "n_free": INT, "error_needs_end": INT,
    "c": FLOATS, "a": FLOATS, "errors": FLOATS, "dense": FLOATS, "free": FLOATS, "free_error": FLOATS,
    "exponent": FLOAT_CELL, "memory": FLOAT_CELL, "stability": FLOAT_CELL,
})  # fmt: skip
"""Coefficients of a Runge-Kutta scheme (`stiffmbs.solve.explicit.scheme`), one column for each stage."""

STEP_BOUND = Layout({"n": INT, "place": INT_CELL, "starts": FLOATS, "longest": FLOATS})
"""Longest steps that resolve inputs (`stiffmbs.solve.events.step_bound`); n is 0 if nothing limits a step."""

LONG_STEPS = Layout({
    "n_nodes": INT, "node": FLOATS, "width": INT, "ratio": FLOAT_CELL, "remembered": FLOAT_CELL, "room": INT_CELL, "count": INT_CELL, "usual": FLOAT_CELL, "row": FLOATS,
})  # fmt: skip
"""Storage of long steps (`stiffmbs.solve.native.long_steps`): one row for both ends of a step and its states, of
`width` numbers, at the nodes.  Cells: ratio of a long step to the usual one, number of steps in the mean that is usual,
space for rows (0 for none), stored rows, usual step."""

ACCUMULATED_ERRORS = Layout({
    "n": INT, "place": INTS, "mass": FLOATS, "displaced": FLOATS, "furthest": FLOATS,
    "n_damped": INT, "damped_source": INTS, "damped_row": INTS, "damped_column": INTS, "damped_factor": FLOATS,
    "each": FLOAT_CELL, "damping": FLOAT_CELL, "speed_error": FLOAT_CELL, "path": FLOAT_CELL, "time": FLOAT_CELL, "since": INT_CELL, "span": FLOAT_CELL,
})  # fmt: skip
"""Accumulated local errors of velocities (`stiffmbs.solve.native.accumulated_errors`): positions of the velocities
among the unknowns, their masses, displacements of positions, and the largest ones so far; entries of the derivatives of
forces by velocities.  Cells: change of the speed by the last error, damping rate, 1/s, error of the speed,
mass-weighted path and its time, s; steps since the last displacement, and their length, s."""

EXPLICIT = Layout({
    "dynamics": INTS, "eliminated": INTS, "eliminates": INT_CELL, "pivots_tell": INT, "scheme": INTS, "n": INT, "n_q": INT, "project": INT_CELL,
    "tolerance": FLOAT_CELL, "rtol": FLOAT_CELL, "atol": FLOATS, "longest": FLOAT_CELL, "stable": FLOAT_CELL, "shortest": FLOAT_CELL, "step_bound": INTS,
    "t": FLOAT_CELL, "t_before": FLOAT_CELL, "span": FLOAT_CELL, "h": FLOAT_CELL, "last_error": FLOAT_CELL,
    "n_event_functions": INT, "end_at_event": INT, "signs": FLOATS, "at_event": INT_CELL, "uncertain": INT_CELL, "watch": INTS,
    "started": INT_CELL, "lam": FLOATS, "y": FLOATS, "y_before": FLOATS, "y_stage": FLOATS, "k": FLOATS, "difference": FLOATS, "weight": FLOATS, "polynomial": FLOATS,
    "dense_ready": INT_CELL, "steps": INT_CELL, "rejected": INT_CELL, "accelerations": INT_CELL, "stiff_steps": INT_CELL, "far_beyond": INT_CELL,
    "long_steps": INTS, "accumulated": INTS, "halved": FLOATS, "measured": INT_CELL, "repeats": FLOAT_CELL,
    "n_times": INT, "times": FLOATS, "next_time": INT_CELL,
    "capacity": INT, "rows": INT_CELL, "row_t": FLOATS, "row_y": FLOATS, "ends": FLOATS,
})  # fmt: skip
"""Explicit integration between two calls: the state y = (q, u) now and before the last step of length `span`; its event
functions; the stages k; inverse tolerances of the last attempt; the number of polynomials of the last step (0 if not
computed); counters; output times (none for every step); memory for the rows and ends of steps in one call.  `started`
is 0 before a restart: the state, its accelerations in the last stage, and `lam` are then consistent.  `measured` is 1
if `halved` has the result of two half steps; `repeats` is the number of periods of laws that end a step in each."""

NATIVE_IDA = Layout({
    "state": INTS, "equations": INTS, "array_of": INT, "matrix": INT, "pattern": INTS,
    "n_event_functions": INT, "signs": FLOATS, "masked": INTS,
    "memory": INT, "y": INT, "yp": INT, "at_output": INT, "output": FLOATS, "n_reported": INT, "reported": INTS,
    "solve": INT, "interpolate": INT, "time_of": INT, "order_of": INT, "step_of": INT,
    "stop_at": INT, "next_step_of": INT, "step_bound": INTS,
    "returned": FLOAT_CELL, "internal": FLOAT_CELL, "size": FLOAT_CELL, "next_size": FLOAT_CELL, "order": INT_CELL,
    "stopping": FLOAT_CELL, "served": INT_CELL, "tiny": INT_CELL, "within": INT_CELL,
    "recorded": INT_CELL, "history": FLOATS, "since_sample": INT_CELL, "next_sample": INT_CELL, "samples": FLOATS,
    "output_correction": INTS, "iteration": INTS, "watch": INTS, "look_at_start": INT, "look_within": INT, "probe": FLOATS, "residual": FLOATS, "weights": INT,
    "long_steps": INTS, "accumulated": INTS, "errors_of": INT, "error_norm": INTS,
    "trace": INT_CELL, "traced": INT_CELL, "seen": FLOAT_CELL,
})  # fmt: skip
"""Memory of the callbacks and the loop of the native IDA (`stiffmbs.solve.native.ida_loop`): addresses of SUNDIALS
functions and objects, values and pattern of the matrix, and reported unknowns.

Cells: times of the returned state and of IDA's internal state; size (0 before the first) and order of its last step,
size of the next attempt; last stop time; output times served, tiny steps in succession, 1 if the last event was found
within the step; steps in the history, steps since the last sample, position of the next one; address of rows for time,
order, y and y' of each step (0 for none), and rows written in this call; time of the event functions in the state."""

MOST_STEPS, HISTORY_ROWS, HISTORY_WIDTH = 2048, 4096, 3
"""Steps of a call up to a breakpoint, and rows of the history of a call: time of the end, order, size."""

SAMPLES = 16
"""Number of samples of time and reported unknowns."""

START = Layout({
    "dynamics": INTS, "ida": INT, "error_norm": INTS, "n_watched": INT, "rate": FLOATS, "leader": INTS,
    "n_q": INT, "q_of": INTS, "q_at": INTS, "n_u": INT, "u_of": INTS, "u_at": INTS,
    "creep": FLOATS, "n_position_entries": INT, "position_source": INTS, "position_row": INTS, "position_creep": FLOAT_CELL,
    "n_velocity_entries": INT, "velocity_source": INTS, "velocity_row": INTS, "lightness": FLOATS, "velocity_creep": FLOAT_CELL,
    "n_sets": INT, "at_relaxations": INTS, "sums": FLOATS,
    "n_f_q": INT, "f_q_source": INTS, "f_q_row": INTS, "f_q_scale": FLOATS, "n_f_u": INT, "f_u_source": INTS, "f_u_row": INTS, "f_u_scale": FLOATS,
    "soft": FLOAT_CELL, "loosest": FLOAT_CELL, "tightest": FLOAT_CELL, "growth": FLOAT_CELL,
    "of_positions": FLOAT_CELL, "of_velocities": FLOAT_CELL, "newton": FLOAT_CELL,
    "n_counters": INT, "counter": INTS, "count": INTS, "counts": INTS,
    "set_newton": INT, "start_anew": INT, "set_first_step": INT, "set_growth": INT, "set_highest_order": INT,
})  # fmt: skip
"""Data of IDA's compiled starts (`stiffmbs.solve.ida.native.start`): independent coordinates and velocities, and their
positions among the unknowns; entries for the relaxations and the Newton tolerance; positions of relaxations in each
term set; IDA's counter functions, space for one number, and their sums; functions of SUNDIALS.  A start changes only
both bounds of the stiffness, and the part of the tolerance that Newton's iteration may leave."""

RESTART = Layout({"start": INTS, "q": FLOATS, "u": FLOATS})
"""Restart of IDA after a jump of inputs (`stiffmbs.solve.ida.native.restart`), with the state between calls."""

ANEW = Layout({
    "start": INTS, "n_event_functions": INT, "first_limit": INT, "n_counted": INT, "counted_source": INTS, "counted_row": INTS,
    "reach": FLOAT_CELL, "along_q": FLOATS, "along_u": FLOATS, "q": FLOATS, "u": FLOATS, "values": FLOATS, "found": INTS,
    "t": FLOAT_CELL, "jump": FLOAT_CELL, "meets": INT_CELL,
    "amplified": FLOAT_CELL, "least": FLOAT_CELL, "largest_jump": FLOAT_CELL, "indistinct": FLOAT_CELL, "passed": INT_CELL, "steps_before": INT_CELL,
})  # fmt: skip
"""Data of restarts of IDA after an event or a breakpoint (`stiffmbs.solve.ida.native.anew`): event functions, the first
of those that are limits of forces; revolution counters and their angles; a move to both sides of a state; memory for a
state and event functions.  Cells: size of the move; time of the restart, largest velocity change, 1 if event functions
of velocities change sign between both sides.  For breakpoints passed in one call (`stiffmbs.solve.ida.native.passing`):
factor of long steps and least residual within them; largest velocity change without a report; relative tolerance of
equal times; number of breakpoints passed, and steps before the last."""

OUTPUT_CORRECTION = Layout({
    "factored": FLOAT_CELL, "current": FLOAT_CELL, "enough": FLOAT_CELL, "long": FLOAT_CELL,
    "made": FLOAT_CELL, "growth": FLOAT_CELL, "since": INT_CELL,
    "balanced": FLOAT_CELL, "unseen": INT_CELL, "next_look": INT_CELL, "force_end": INTS, "force_row": INTS,
    "local": FLOAT_CELL, "judged": INT_CELL, "n_joint_rows": INT, "joint_row": INTS, "dynamics": INTS, "pose": FLOATS,
    "memory": INT, "interpolate": INT, "weights": INT, "clear": INT, "setup": INT, "solve": INT,
    "solver": INT, "matrix": INT, "entries": INT, "pattern": INTS,
    "at_y": INT, "y": FLOATS, "at_yp": INT, "yp": FLOATS, "at_defect": INT, "defect": FLOATS,
    "at_correction": INT, "correction": FLOATS, "at_weight": INT, "weight": FLOATS, "size": FLOATS,
})  # fmt: skip
"""Newton's iteration on interpolated states (`stiffmbs.solve.native.output_correction`).

Cells: cj of the factors (0 for none), cj of IDA, part of the tolerance that may remain, step, s, above which states
within it are corrected; time of the factors, growth of the convergence rate per second from there (negative if
unknown), states corrected since its measurement; allowed imbalance relative to the largest force, number of states not
checked after a balanced one, and the remaining number.  Then rows of the equations of motion, forces before moments,
and their ends; effect of closing joints by 1 m on the imbalance, in units of the allowed one, and the number of states
for which it is used; rows of position constraints; system that closes joints; memory for a pose."""

ITERATION = Layout({
    "n": INT, "by_reactions": INT, "memory": INT, "array_of": INT, "cj_of": INT, "iteration_of": INT,
    "cj": FLOAT_CELL, "matrix_cj": FLOAT_CELL, "first": FLOAT_CELL, "by_cj": FLOAT_CELL, "growth": FLOAT_CELL, "span": FLOAT_CELL,
    "done": INT_CELL, "age": INT_CELL, "since": INT_CELL, "slow": INT_CELL, "given_up": INT_CELL,
})  # fmt: skip
"""Convergence test of Newton's iteration in a step (`stiffmbs.solve.native.iteration`).

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
})  # fmt: skip
"""Norm of IDA's error estimates (`stiffmbs.solve.native.error_norm`).

Cells: failures of the error test with a weight that decreases with each step; 1 to filter all estimates; cj at the last
check of failures; steps and failures of the error test, and the same at the last check; step up to which estimates are
filtered; order of the last step; number of periods of a law whose features are resolved, else 1; step up to which steps
may not grow (0 for none), and least growth factor afterwards."""

EVENT_SEARCH = Layout({
    "n": INT, "n_event_functions": INT, "masked": INTS, "first_edge": INTS, "edges": FLOATS, "overlap": FLOATS, "period": FLOATS,
    "value_before": FLOATS, "rate_before": FLOATS, "value_after": FLOATS, "rate_after": FLOATS,
    "a": FLOATS, "a_rate": FLOATS, "b": FLOATS, "b_rate": FLOATS, "m": FLOATS, "m2": FLOATS, "left_low": FLOATS, "left_high": FLOATS, "noise": FLOATS, "found": INTS,
    "zone_low": FLOATS, "zone_high": FLOATS, "apart": FLOATS, "n_calls": INT, "call": INTS, "near": INTS,
    "n_state": INT, "n_nodes": INT, "node": FLOATS, "weight": FLOATS, "row": FLOATS, "n_angles": INT, "angle": INTS, "n_turns": INT, "turn": INTS, "radians": FLOATS, "lands": INTS, "n_zoned": INT,
    "ready": INT_CELL, "begun": FLOAT_CELL, "depth": FLOAT_CELL,
    "least": FLOAT_CELL, "duration": FLOAT_CELL, "longest": FLOAT_CELL, "target": FLOAT_CELL, "passage": FLOAT_CELL, "first": FLOAT_CELL, "under_way": INT_CELL, "begins": FLOAT_CELL, "narrow": INT_CELL, "passed": FLOAT_CELL, "unresolved": INT_CELL, "fastest": INT_CELL, "first_unresolved": FLOAT_CELL,
})  # fmt: skip
"""Search for events within a step (`stiffmbs.solve.native.event_search.within_step`): event functions with their
breakpoints; their values and rates at both ends of the step and of a part of it; the kernel of each, and kernels with a
function near a breakpoint; states of the step at nodes; arguments of sines or of periodic tables with few intervals,
and their unit in radians; functions whose breakpoints end steps; number of functions with breakpoints.

Cells: 1 if values at the start of the step are known, time of that start, least depth of an event below zero; shortest
and longest step for the arguments of sines; longest step until the motion leaves its initial law, longest first step
there; 1 after the beginning of the run, time of the beginning, number of steps limited by features, end of the passage;
number of steps with unresolved arguments, first such argument, and its time."""
