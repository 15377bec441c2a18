"""What compiled code works on as it integrates: IDA and explicit steps, and what is seen within them."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, INTS, Layout

IDA = Layout({
    "state": INTS, "equations": INTS, "array_header": INT, "n_event_functions": INT, "signs": FLOATS, "masked": INTS,
    "last_time": FLOAT_CELL, "steps": INT_CELL, "rejected": INT_CELL, "n_ends": INT, "ends": FLOATS,
})  # fmt: skip
"""What IDA's callbacks work on; `array_header` is the size of the header before the data pointer of a numpy array.  They
note the last time asked for, count steps accepted and rejected, and keep the first ends of steps."""

SCHEME = Layout({
    "order": INT, "stages": INT, "extended": INT, "n_errors": INT, "n_dense": INT, "n_free": INT, "error_needs_end": INT,
    "c": FLOATS, "a": FLOATS, "errors": FLOATS, "dense": FLOATS, "free": FLOATS, "free_error": FLOATS,
    "exponent": FLOAT_CELL, "memory": FLOAT_CELL, "stability": FLOAT_CELL,
})  # fmt: skip
"""The coefficients of a Runge-Kutta scheme (`stiffmbs.solve.explicit.scheme`), one column for each stage."""

STEP_BOUND = Layout({"n": INT, "place": INT_CELL, "starts": FLOATS, "longest": FLOATS})
"""The longest steps that see what the inputs do (`stiffmbs.solve.events.step_bound`); n is 0 where nothing bounds a step."""

LONG_STEPS = Layout({
    "n_nodes": INT, "node": FLOATS, "width": INT, "ratio": FLOAT_CELL, "remembered": FLOAT_CELL, "room": INT_CELL, "count": INT_CELL, "usual": FLOAT_CELL, "row": FLOATS,
})  # fmt: skip
"""Where steps far longer than those before are kept (`stiffmbs.solve.native.long_steps`): one row each of the step's two ends and its
states, of `width` numbers, at the nodes.  Cells: times the usual step beyond which a step is long, and of how many steps the usual one
is the mean; rows there is room for (0 where none is kept), rows kept, the usual step."""

ACCUMULATED_ERRORS = Layout({
    "n": INT, "place": INTS, "mass": FLOATS, "displaced": FLOATS, "furthest": FLOATS,
    "n_damped": INT, "damped_source": INTS, "damped_row": INTS, "damped_column": INTS, "damped_factor": FLOATS,
    "each": FLOAT_CELL, "damping": FLOAT_CELL, "speed_error": FLOAT_CELL, "path": FLOAT_CELL, "time": FLOAT_CELL, "since": INT_CELL, "span": FLOAT_CELL,
})  # fmt: skip
"""What local errors of velocities come to (`stiffmbs.solve.native.accumulated_errors`): where the velocities stand among the unknowns, their
masses, how far positions are displaced, and the largest amounts of that so far; entries of the derivatives of forces by velocities.  Cells: what
the last error that was read adds to the speed, the rate at which forces damp the motion, 1/s, the error of the speed, the path so
far, weighted with masses, and its time, s; steps since positions were displaced, and their length, s."""

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
"""An explicit integration between two calls: the state y = (q, u) now and before the last step (of length `span`), the
event functions' values there, the stages k, one over the tolerance of each number in the last step tried, how many polynomials describe
the last step (0: they are not made), the counters, the output times (none: every step), and memory for the rows and ends of steps that one call stores.  Where steps are to start anew
`started` is 0: the state, its accelerations in the last stage, and `lam` are consistent values then.  `measured` is 1 where `halved` has the
state that two steps of half the length lead to; `repeats` is how often laws repeat whose features end a step in each turn."""

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
"""What the callbacks and the loop of the native IDA work on (`stiffmbs.solve.native.ida_loop`): functions and objects
of SUNDIALS by their addresses, the values of the matrix, how its pattern is written, and what is reported.

Cells: the time of the returned state, the time that IDA has reached inside, size (0 before the first) and order of its
last step, size of the one that it will try next; where it was last told to stop; output points served, tiny steps in succession, whether the last event
was found by the search within the step; steps in the history, steps since the last sample, place of the next one; the address
of rows for time, order, y and y' of each step (0: none are kept), and rows written in this call; the time for which the state holds the values of event functions."""

MOST_STEPS, HISTORY_ROWS, HISTORY_WIDTH = 2048, 4096, 3
"""Steps of any one call up to a breakpoint, and of all that it passes, which the history has rows for: time of the end, order, size."""

SAMPLES = 16
"""Rows of the samples: the time and what is reported."""

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
"""What IDA is started with at consistent values (`stiffmbs.solve.ida.native.start`): independent coordinates and velocities, and where
they stand among the unknowns; the entries that relaxations and the tolerance of Newton's iteration follow from, and where relaxations
stand in each term set; functions that read IDA's counters, room for one number, and the sums of what they gave; functions of SUNDIALS.
Cells are set once, but for what a start leaves behind: bounds on the stiffness, and the part of the tolerance that Newton's
iteration may leave."""

RESTART = Layout({"start": INTS, "q": FLOATS, "u": FLOATS})
"""What IDA is started anew with behind a jump of inputs (`stiffmbs.solve.ida.native.restart`): the state from one call to the next."""

ANEW = Layout({
    "start": INTS, "n_event_functions": INT, "first_limit": INT, "n_counted": INT, "counted_source": INTS, "counted_row": INTS,
    "reach": FLOAT_CELL, "along_q": FLOATS, "along_u": FLOATS, "q": FLOATS, "u": FLOATS, "values": FLOATS, "found": INTS,
    "t": FLOAT_CELL, "jump": FLOAT_CELL, "meets": INT_CELL,
    "amplified": FLOAT_CELL, "least": FLOAT_CELL, "largest_jump": FLOAT_CELL, "indistinct": FLOAT_CELL, "passed": INT_CELL, "steps_before": INT_CELL,
})  # fmt: skip
"""What IDA is started anew with behind an event or a breakpoint (`stiffmbs.solve.ida.native.anew`): event functions, the first of those that
are limits of forces, counters of turns and the angles that they count, a move to both sides of a state, and memory for a state and
event functions.  Cells: the size of the move; where it was started, the largest change of a velocity, and whether event functions that follow
velocities change between both sides; for breakpoints that are passed in one call (`stiffmbs.solve.ida.native.passing`) what the length of
long steps and the residual of states within them follow from, the largest change of a velocity that need not be told, the part of a time
within which another one is the same, how many were passed, and the steps of the call before the last of them."""

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
"""Newton's iteration on an interpolated state (`stiffmbs.solve.native.output_correction`): functions, linear solver, and vectors.

Cells: cj of the factors (0 where there are none), cj of IDA's, the part of the tolerance that may be left, the step, s,
beyond which states within it are corrected; the time at which the factors were made, what the rate of convergence
grows by in a second from there (below 0: not known), and states corrected since that was measured; the part of the largest
force that may be left, states that are not looked at after one that is balanced, and those of them that are to come.  The rows of the
equations of motion: those of forces, then those of moments, and where either end.  What closing joints left of the forces
for an opening of 1 m, in units of what may be left, and for how many states that serves; the rows of position constraints, the system
that joints are closed by, and memory for a pose."""

ITERATION = Layout({
    "n": INT, "by_reactions": INT, "memory": INT, "array_of": INT, "cj_of": INT, "iteration_of": INT,
    "cj": FLOAT_CELL, "matrix_cj": FLOAT_CELL, "first": FLOAT_CELL, "by_cj": FLOAT_CELL, "growth": FLOAT_CELL, "span": FLOAT_CELL,
    "done": INT_CELL, "age": INT_CELL, "since": INT_CELL, "slow": INT_CELL, "given_up": INT_CELL,
})  # fmt: skip
"""What the convergence test of Newton's iteration in a step works on (`stiffmbs.solve.native.iteration`).

Cells: cj, that of the matrix, size of the first correction, the part of the rate by the change of cj, what the rest grows by
in a time (below 0: not known), and the time since the matrix was made, by the sum of 1/cj, which a step is but for a factor
of 1 to 2.3; corrections before this one, steps since the matrix was made, steps since a rate was measured, whether the
matrix is to be made anew."""

ERROR_NORM = Layout({
    "memory": INT, "norm": INT, "array_of": INT, "steps_of": INT, "failures_of": INT, "order_of": INT,
    "trouble": FLOAT_CELL, "always": INT_CELL, "looked": FLOAT_CELL, "steps": INT_CELL, "failures": INT_CELL,
    "known_steps": INT_CELL, "known_failures": INT_CELL, "until": INT_CELL, "order": INT_CELL, "repeats": FLOAT_CELL,
    "equal_until": INT_CELL, "growth": FLOAT_CELL, "set_growth": INT,
    "iteration": INTS, "state": INTS, "equations": INTS, "solve": INT, "solver": INT, "matrix": INT, "at_change": INT, "change": FLOATS, "at_filtered": INT, "filtered": FLOATS,
})  # fmt: skip
"""What the norm of IDA's error estimates works on (`stiffmbs.solve.native.error_norm`).

Cells: failures of the error test, each counted less with each step since then; whether all estimates are filtered; cj when
failures were last looked for; steps and failures of the error test, the same when they were last looked at; the step up to
which estimates are filtered; the order of the last step; how often a law repeats where steps resolve one of its features, else 1; the step up to which steps may not grow (0: they may), and the factor by
which the test must let them grow else."""

EVENT_SEARCH = Layout({
    "n": INT, "n_event_functions": INT, "masked": INTS, "first_edge": INTS, "edges": FLOATS, "overlap": FLOATS, "period": FLOATS,
    "value_before": FLOATS, "rate_before": FLOATS, "value_after": FLOATS, "rate_after": FLOATS,
    "a": FLOATS, "a_rate": FLOATS, "b": FLOATS, "b_rate": FLOATS, "m": FLOATS, "m2": FLOATS, "left_low": FLOATS, "left_high": FLOATS, "noise": FLOATS, "found": INTS,
    "zone_low": FLOATS, "zone_high": FLOATS, "apart": FLOATS, "n_calls": INT, "call": INTS, "near": INTS,
    "n_state": INT, "n_nodes": INT, "node": FLOATS, "weight": FLOATS, "row": FLOATS, "n_angles": INT, "angle": INTS, "n_turns": INT, "turn": INTS, "radians": FLOATS, "lands": INTS, "n_zoned": INT,
    "ready": INT_CELL, "begun": FLOAT_CELL, "depth": FLOAT_CELL,
    "least": FLOAT_CELL, "duration": FLOAT_CELL, "longest": FLOAT_CELL, "target": FLOAT_CELL, "passage": FLOAT_CELL, "first": FLOAT_CELL, "under_way": INT_CELL, "begins": FLOAT_CELL, "narrow": INT_CELL, "passed": FLOAT_CELL, "unresolved": INT_CELL, "fastest": INT_CELL, "first_unresolved": FLOAT_CELL,
})  # fmt: skip
"""What the search for events within a step works on (`stiffmbs.solve.native.event_search.within_step`): the event functions with their
edges, their values and rates at both ends of the step and of a part of it, the kernel that computes each and which kernels
have one near an edge, states of the step at some nodes, which functions are arguments of sines or of periodic tables of few zones with the
radians of a unit of them, of which functions steps end at each edge, and how many functions have edges.

Cells: whether values at the start of the step are known, that start's time, and how far an event function must go beyond
zero; the shortest and the longest step that the arguments of sines ask for, the longest step up to a time at which the motion is to leave the
law at a start, the longest first step there, whether the run has left its beginning, the time of which follows, how many steps a feature of a law has bounded,
and that time; steps in which an argument turned too far to be resolved, the number of the first such argument, and when."""
